!> How a wall moves. The surface of a plane, cylinder or cone moves along itself and the wall stays where it is: a belt runs along
!> its plane, a drum turns about its own axis. A mesh moves as a whole: its centre runs at the velocity, it turns about the centre.
module wall_motion
  use kinds, only: wp
  implicit none
  private
  public :: wall_motion_t, cross

  type :: wall_motion_t
    real(wp) :: velocity(3) = 0.0_wp  !< [m/s]
    real(wp) :: spin(3) = 0.0_wp      !< angular velocity [rad/s]
    real(wp) :: centre(3) = 0.0_wp    !< of the rotation, at the start [m]
  contains
    procedure :: at => velocity_at
    procedure :: is_still
    procedure :: turn
  end type wall_motion_t

contains

  !> Velocity of the wall's surface in a point of it [m/s].
  pure function velocity_at(self, x) result(velocity)
    class(wall_motion_t), intent(in) :: self
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: velocity(3)

    velocity = self%velocity + cross(self%spin, x - self%centre)
  end function velocity_at

  pure function is_still(self)
    class(wall_motion_t), intent(in) :: self
    logical :: is_still

    is_still = .not. (norm2(self%velocity) > 0.0_wp .or. norm2(self%spin) > 0.0_wp)
  end function is_still

  !> The matrix that turns a vector by the angle of a time: cos I + sin [e]x + (1 - cos) e e^T, e along the spin.
  pure function turn(self, time) result(matrix)
    class(wall_motion_t), intent(in) :: self
    real(wp), intent(in) :: time  !< [s]
    real(wp) :: matrix(3, 3)

    real(wp) :: speed, axis(3), unit(3)
    integer :: a

    matrix = 0.0_wp
    speed = norm2(self%spin)
    axis = 0.0_wp
    if (speed > 0.0_wp) axis = self%spin/speed
    do a = 1, 3
      unit = 0.0_wp
      unit(a) = 1.0_wp
      matrix(:, a) = cos(speed*time)*unit + sin(speed*time)*cross(axis, unit) + (1 - cos(speed*time))*axis(a)*axis
    end do
  end function turn

  pure function cross(a, b) result(c)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: c(3)

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross

end module wall_motion
