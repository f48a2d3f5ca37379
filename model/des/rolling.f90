!> Resistance to rolling: a torque against the relative rotation of two that touch, on top of their friction.
!>
!> Of omega_r = omega_i - omega_j only the part across the normal counts: rolling, not spinning. With R = r_i r_j/(r_i + r_j)
!> (r of a parcel on a wall) and F_n, the force of the normal spring and dashpot,
!>
!>   constant torque  M = -mu_r R |F_n| omega_r/|omega_r|                                      (model A)
!>   spring           M = -k_r theta - C_r omega_r,   |k_r theta| <= mu_r R |F_n|              (model C)
!>                    k_r = 2.25 k_n (mu_r R)^2,   C_r = 2 eta sqrt(I_r k_r),   1/I_r = sum 1/(I_i + m_i r_i^2)
!>
!> on i, and -M on j. theta is the angle rolled, kept in the tangent plane and no larger than the limit lets it be; there the
!> dashpot rests. k_n is the stiffness of the linear law, 2 E a of that of Hertz.
!> Source: Ai, Chen, Rotter & Ooi, Powder Technol. 206 (2011) 269-282, models A and C; k_r in two dimensions, 3 k_n (mu_r R)^2,
!>         is of Jiang, Yu & Harris, Comput. Geotech. 32 (2005) 340-357, 2.25 of three dimensions that of LIGGGHTS.
!>
!> A constant torque would turn its sign with every step once a parcel is at rest. It is at most a quarter of what would end
!> the relative rotation within one step: stable with some contacts at once (the rotation is read with its lead, see motion).
!> So it cannot hold a parcel that is pulled, which creeps. The spring holds.
!>
!> theta is that of the end of the step; forces, which belong to the middle, take it half a step before.
module rolling
  use contact_lanes, only: lanes
  use kinds, only: wp
  implicit none
  private
  public :: rolling_t, rolling_torques, spring_factor

  real(wp), parameter :: spring_factor = 2.25_wp       !< k_r/(k_n (mu_r R)^2) [-]
  real(wp), parameter :: per_inertia = 2.5_wp          !< m r^2/I of a sphere [-]
  real(wp), parameter :: per_pivoting = 5.0_wp/7.0_wp  !< m r^2/(I + m r^2) of it [-]
  real(wp), parameter :: share = 0.25_wp               !< of the torque that ends the rotation in one step

  !> Constants of one pair of materials.
  type :: rolling_t
    logical :: on = .false.
    logical :: spring = .false.          !< else a constant torque
    logical :: hertzian = .false.        !< whether k_n is that of Hertz's law
    real(wp) :: mu = 0.0_wp              !< rolling friction mu_r [-]
    real(wp) :: damping = 0.0_wp         !< C_r over its critical value, eta [-]
    real(wp) :: stiffness = 0.0_wp       !< k_n of the linear law [N/m], or E of Hertz's [Pa]
  contains
    procedure :: hurry
  end type rolling_t

contains

  !> By how much the rolling spring may swing faster than the normal one, if it does: 1/I of the two spins is at most
  !> per_inertia/(m* R^2), whatever their sizes.
  elemental function hurry(self) result(factor)
    class(rolling_t), intent(in) :: self
    real(wp) :: factor

    factor = 1.0_wp
    if (self%on .and. self%spring) factor = max(1.0_wp, sqrt(spring_factor*per_inertia)*self%mu)
  end function hurry

  !> Torques on i of n pairs (i, j), n a multiple of `lanes`; those on j are the opposite. A pair without a force has no angle.
  pure subroutine rolling_torques(rolling, dt, n, pair, turn, force, angle, torque)
    type(rolling_t), intent(in) :: rolling
    real(wp), intent(in) :: dt              !< time step, or 0 [s]
    integer, intent(in) :: n
    real(wp), intent(in) :: pair(8, n)      !< 1:3 x_i - x_j, 4 r_i + r_j [m]
    real(wp), intent(in) :: turn(5, n)      !< 1:3 omega_i - omega_j [rad/s], 4 1/R [1/m], 5 sum 1/(m r^2) [1/(kg m2)]
    real(wp), intent(in) :: force(3, n)     !< of the contact, on i [N]
    real(wp), intent(inout) :: angle(3, n)  !< theta; read and written by the spring only [rad]
    real(wp), intent(out) :: torque(3, n)   !< [N m]

    integer :: k

    if (rolling%spring) then
      do k = 1, n, lanes
        call spring_torques(rolling, dt, pair(:, k:k + lanes - 1), turn(:, k:k + lanes - 1), force(:, k:k + lanes - 1), &
                            angle(:, k:k + lanes - 1), torque(:, k:k + lanes - 1))
      end do
    else
      do k = 1, n, lanes
        call constant_torques(rolling, dt, pair(:, k:k + lanes - 1), turn(:, k:k + lanes - 1), force(:, k:k + lanes - 1), &
                              torque(:, k:k + lanes - 1))
      end do
    end if
  end subroutine rolling_torques

  pure subroutine constant_torques(rolling, dt, pair, turn, force, torque)
    type(rolling_t), intent(in) :: rolling
    real(wp), intent(in) :: dt
    real(wp), intent(in) :: pair(8, lanes), turn(5, lanes), force(3, lanes)
    real(wp), intent(out) :: torque(3, lanes)

    real(wp) :: x, y, z, per_square, along, u, v, w, speed, f_n, part
    integer :: k

    !$omp simd simdlen(8) private(x, y, z, per_square, along, u, v, w, speed, f_n, part)
    do k = 1, lanes
      x = pair(1, k)
      y = pair(2, k)
      z = pair(3, k)
      per_square = 1/(x*x + y*y + z*z)
      along = (turn(1, k)*x + turn(2, k)*y + turn(3, k)*z)*per_square
      u = turn(1, k) - along*x
      v = turn(2, k) - along*y
      w = turn(3, k) - along*z
      speed = sqrt(max(u*u + v*v + w*w, tiny(speed)))
      f_n = abs(force(1, k)*x + force(2, k)*y + force(3, k)*z)*sqrt(per_square)
      part = min(rolling%mu*f_n/(turn(4, k)*speed), share/max(dt*per_inertia*turn(5, k), tiny(part)))
      torque(1, k) = -part*u
      torque(2, k) = -part*v
      torque(3, k) = -part*w
    end do
  end subroutine constant_torques

  pure subroutine spring_torques(rolling, dt, pair, turn, force, angle, torque)
    type(rolling_t), intent(in) :: rolling
    real(wp), intent(in) :: dt
    real(wp), intent(in) :: pair(8, lanes), turn(5, lanes), force(3, lanes)
    real(wp), intent(inout) :: angle(3, lanes)
    real(wp), intent(out) :: torque(3, lanes)

    real(wp) :: x, y, z, square, per_d, along, u, v, w, a, b, c, f_n, k_n, k_r, cap, c_r, most, size, delta, hold
    integer :: k

    !$omp simd simdlen(8) private(x, y, z, square, per_d, along, u, v, w, a, b, c, f_n, k_n, k_r, cap, c_r, most, size, delta, hold)
    do k = 1, lanes
      x = pair(1, k)
      y = pair(2, k)
      z = pair(3, k)
      square = x*x + y*y + z*z
      per_d = 1/sqrt(square)
      f_n = abs(force(1, k)*x + force(2, k)*y + force(3, k)*z)*per_d
      k_n = rolling%stiffness
      if (rolling%hertzian) then
        delta = max(pair(4, k) - square*per_d, tiny(delta))
        k_n = 2*rolling%stiffness*sqrt(delta/turn(4, k))
      end if
      k_r = spring_factor*k_n*(rolling%mu/turn(4, k))**2
      c_r = 2*rolling%damping*sqrt(k_r/(per_pivoting*turn(5, k)))

      ! The rolling part of the rotation, and the angle in the middle of the step, both in the tangent plane.
      along = (turn(1, k)*x + turn(2, k)*y + turn(3, k)*z)*per_d*per_d
      u = turn(1, k) - along*x
      v = turn(2, k) - along*y
      w = turn(3, k) - along*z
      a = angle(1, k) + 0.5_wp*dt*u
      b = angle(2, k) + 0.5_wp*dt*v
      c = angle(3, k) + 0.5_wp*dt*w
      along = (a*x + b*y + c*z)*per_d*per_d
      a = a - along*x
      b = b - along*y
      c = c - along*z

      most = rolling%mu*f_n/turn(4, k)
      size = k_r*sqrt(a*a + b*b + c*c)
      cap = min(most/max(size, sqrt(tiny(size))), 1.0_wp)
      c_r = merge(c_r, 0.0_wp, size < most)
      a = cap*a
      b = cap*b
      c = cap*c
      torque(1, k) = -(k_r*a + c_r*u)
      torque(2, k) = -(k_r*b + c_r*v)
      torque(3, k) = -(k_r*c + c_r*w)
      hold = merge(1.0_wp, 0.0_wp, f_n > 0.0_wp)
      angle(1, k) = hold*(a + 0.5_wp*dt*u)
      angle(2, k) = hold*(b + 0.5_wp*dt*v)
      angle(3, k) = hold*(c + 0.5_wp*dt*w)
    end do
  end subroutine spring_torques

end module rolling
