!> Pairs in the lanes of vectors: how many at a time, and the way back to a row for each pair.
module contact_lanes
  use kinds, only: wp
  implicit none
  private
  public :: lanes, never, turn_eight, turn_four

  integer, parameter :: lanes = 8            !< pairs computed at a time
  real(wp), parameter :: never = -1.0_wp     !< the last touch of a pair that does not touch, or has not yet

contains

  !> Rows for pairs from rows for components.
  pure subroutine turn_eight(from, to)
    real(wp), intent(in) :: from(lanes, 8)
    real(wp), intent(out) :: to(8, lanes)

    integer :: m

    !$omp simd simdlen(8)
    do m = 1, 8
      to(m, 1) = from(1, m)
      to(m, 2) = from(2, m)
      to(m, 3) = from(3, m)
      to(m, 4) = from(4, m)
      to(m, 5) = from(5, m)
      to(m, 6) = from(6, m)
      to(m, 7) = from(7, m)
      to(m, 8) = from(8, m)
    end do
  end subroutine turn_eight

  !> The same of four components.
  pure subroutine turn_four(from, to)
    real(wp), intent(in) :: from(lanes, 4)
    real(wp), intent(out) :: to(4, lanes)

    integer :: m

    !$omp simd simdlen(4)
    do m = 1, 4
      to(m, 1) = from(1, m)
      to(m, 2) = from(2, m)
      to(m, 3) = from(3, m)
      to(m, 4) = from(4, m)
      to(m, 5) = from(5, m)
      to(m, 6) = from(6, m)
      to(m, 7) = from(7, m)
      to(m, 8) = from(8, m)
    end do
  end subroutine turn_four

end module contact_lanes
