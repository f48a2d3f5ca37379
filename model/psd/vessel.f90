!> The space parcels start in: a box, some of whose opposite faces may be joined.
module vessel
  use kinds, only: wp
  implicit none
  private
  public :: vessel_t

  type :: vessel_t
    real(wp) :: lower(3)    !< lowest corner [m]
    real(wp) :: upper(3)    !< highest corner [m]
    logical :: periodic(3)  !< whether opposite faces are joined
  contains
    procedure :: periods    !< what brings a way between two points to the nearest image
    procedure :: shortest   !< the way to the nearest image
  end type vessel_t

contains

  !> The way between two points, or their nearest images, is the component w or, where it is longer than `half`,
  !> w - length; shorter than -half, w + length.
  pure subroutine periods(self, length, half)
    class(vessel_t), intent(in) :: self
    real(wp), intent(out) :: length(3)  !< period, 0 where there is none [m]
    real(wp), intent(out) :: half(3)    !< half of it, beyond all ways where there is none [m]

    length = merge(self%upper - self%lower, 0.0_wp, self%periodic)
    half = merge(0.5_wp*length, huge(1.0_wp), self%periodic)
  end subroutine periods

  !> A way between two points, made the way to the nearest image [m].
  pure function shortest(self, way) result(vector)
    class(vessel_t), intent(in) :: self
    real(wp), intent(in) :: way(3)  !< [m]
    real(wp) :: vector(3)

    real(wp) :: length(3), half(3)

    call self%periods(length, half)
    vector = way - merge(length, 0.0_wp, way > half) + merge(length, 0.0_wp, way < -half)
  end function shortest

end module vessel
