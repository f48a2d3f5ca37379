!> What tells where the gas may be.
module level
  use kinds, only: wp
  implicit none
  private
  public :: level_t

  !> Something with walls.
  type, abstract :: level_t
  contains
    procedure(level_at), deferred :: at
  end type level_t

  abstract interface
    !> Distance from the nearest wall where the gas may be, negative beyond it [m]. No farther from walls than half the diagonal
    !> of a cell it is exact; farther it need only be larger than that. Only where walls end may it jump.
    pure function level_at(self, x) result(distance)
      import :: level_t, wp
      implicit none
      class(level_t), intent(in) :: self
      real(wp), intent(in) :: x(3)  !< [m]
      real(wp) :: distance
    end function level_at
  end interface

end module level
