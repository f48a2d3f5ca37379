!> How the surface of a wall moves. The wall itself stays where it is: a belt runs along its plane, a drum turns about
!> its own axis.
module wall_motion
  use kinds, only: wp
  implicit none
  private
  public :: wall_motion_t, cross

  type :: wall_motion_t
    real(wp) :: velocity(3) = 0.0_wp  !< [m/s]
    real(wp) :: spin(3) = 0.0_wp      !< angular velocity [rad/s]
    real(wp) :: centre(3) = 0.0_wp    !< of the rotation [m]
  contains
    procedure :: at => velocity_at
  end type wall_motion_t

contains

  !> Velocity of the wall's surface in a point of it [m/s].
  pure function velocity_at(self, x) result(velocity)
    class(wall_motion_t), intent(in) :: self
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: velocity(3)

    velocity = self%velocity + cross(self%spin, x - self%centre)
  end function velocity_at

  pure function cross(a, b) result(c)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: c(3)

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross

end module wall_motion
