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
    procedure(level_moves), deferred :: moves
    procedure(level_velocity), deferred :: velocity
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

    !> Whether the surface of any wall does, along itself.
    pure function level_moves(self) result(moves)
      import :: level_t
      implicit none
      class(level_t), intent(in) :: self
      logical :: moves
    end function level_moves

    !> That of the surface of the nearest wall, where it is nearest to a point [m/s].
    pure function level_velocity(self, x) result(velocity)
      import :: level_t, wp
      implicit none
      class(level_t), intent(in) :: self
      real(wp), intent(in) :: x(3)  !< [m]
      real(wp) :: velocity(3)
    end function level_velocity
  end interface

end module level
