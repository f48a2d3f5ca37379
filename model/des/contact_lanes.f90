!> Pairs in the lanes of vectors: how many at a time, and the way back to a row for each pair.
module contact_lanes
  use kinds, only: wp
  implicit none
  private
  public :: lanes, full_lanes, lane_of, group_of, record_rows, turn_eight, turn_four

  integer, parameter :: lanes = 8            !< pairs computed at a time

  !> What is kept of pairs from step to step, eight by eight as the laws read it: (lanes, record_rows, groups).
  !> Rows 1:3 tangential slip [m], zero of a pair that does not touch; 4 square root of the effective mass [sqrt(kg)];
  !> 5 1/(r_i + r_j) [1/m].
  integer, parameter :: record_rows = 5

contains

  !> The least multiple of `lanes` that holds n pairs.
  elemental function full_lanes(n)
    integer, intent(in) :: n
    integer :: full_lanes

    full_lanes = lanes*((n + lanes - 1)/lanes)
  end function full_lanes

  !> The lane of the n-th pair.
  elemental function lane_of(n)
    integer, intent(in) :: n
    integer :: lane_of

    lane_of = 1 + modulo(n - 1, lanes)
  end function lane_of

  !> The group of lanes that has the n-th pair.
  elemental function group_of(n)
    integer, intent(in) :: n
    integer :: group_of

    group_of = 1 + (n - 1)/lanes
  end function group_of

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
