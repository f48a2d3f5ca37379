!> A sphere that hits a rigid plane, by the equations of Hertz's law: three velocities, overlap and slip as functions of
!> time, integrated by Runge and Kutta in steps so short that nothing is left of their errors.
!>
!>   m v_n' = F_n,  m v_t' = F_t,  (2/5) m w' = -F_t (r - delta)/r,  delta' = -v_n,  xi' = v_t - w (r - delta)/r
!>   F_n = 4/3 E sqrt(r) delta^(3/2) - sqrt(10/3) zeta sqrt(2 E sqrt(r delta) m) v_n
!>   F_t = -8 G sqrt(r delta) xi - gamma_t (v_t - w (r - delta)/r),  |F_t| <= mu |F_n|
!>
!> w is the spin times the radius; 1/E = (1 - nu^2)/E_1, 1/G = (2 - nu)/G_1. Where it slides xi is what the spring needs.
module hertz_contact
  use constants, only: pi
  use kinds, only: wp
  use spring_contact, only: damping_ratio
  implicit none
  private
  public :: hertz_ball_t, rebound

  type :: hertz_ball_t
    real(wp) :: radius, density          !< [m], [kg/m3]
    real(wp) :: modulus, poisson         !< Young's [Pa], [-]
    real(wp) :: restitution, friction    !< [-], [-]
    real(wp) :: tangential_damping       !< gamma_t/gamma_n [-]
  end type hertz_ball_t

contains

  !> Velocities after the impact: along the normal, along the plane, spin times radius [m/s].
  pure function rebound(ball, v_n, v_t, spin) result(after)
    type(hertz_ball_t), intent(in) :: ball
    real(wp), intent(in) :: v_n, v_t, spin  !< approach, along the plane, spin times radius before [m/s]
    real(wp) :: after(3)

    integer, parameter :: steps = 20000  !< in an elastic contact
    real(wp) :: y(5), a(5), b(5), c(5), d(5), dt

    y = [-v_n, v_t, spin, 0.0_wp, 0.0_wp]
    dt = 2.943276_wp*deepest(ball, v_n)/v_n/steps
    do
      a = rate(ball, y)
      b = rate(ball, y + dt/2*a)
      c = rate(ball, y + dt/2*b)
      d = rate(ball, y + dt*c)
      y = y + dt/6*(a + 2*b + 2*c + d)
      if (y(4) <= 0) exit
      y(5) = held_slip(ball, y)
    end do
    after = y(1:3)
  end function rebound

  pure function mass(ball)
    type(hertz_ball_t), intent(in) :: ball
    real(wp) :: mass

    mass = ball%density*4*pi/3*ball%radius**3
  end function mass

  pure function e_star(ball)
    type(hertz_ball_t), intent(in) :: ball
    real(wp) :: e_star

    e_star = ball%modulus/(1 - ball%poisson**2)
  end function e_star

  !> Largest overlap of an elastic impact [m].
  pure function deepest(ball, v)
    type(hertz_ball_t), intent(in) :: ball
    real(wp), intent(in) :: v
    real(wp) :: deepest

    deepest = (15*mass(ball)*v**2/(16*e_star(ball)*sqrt(ball%radius)))**0.4_wp
  end function deepest

  !> Velocity of the contact point, normal force and damping at an overlap; stiffness of the tangential spring.
  pure subroutine contact_of(ball, y, point, f_n, gamma_t, k_t)
    type(hertz_ball_t), intent(in) :: ball
    real(wp), intent(in) :: y(5)                         !< v_n, v_t, w [m/s], delta, xi [m]
    real(wp), intent(out) :: point, f_n, gamma_t, k_t    !< [m/s], [N], [kg/s], [N/m]

    real(wp) :: a, delta, gamma_n

    delta = max(y(4), 0.0_wp)
    a = sqrt(ball%radius*delta)
    gamma_n = sqrt(10.0_wp/3.0_wp)*damping_ratio(ball%restitution)*sqrt(2*e_star(ball)*a*mass(ball))
    f_n = 4.0_wp/3.0_wp*e_star(ball)*a*delta - gamma_n*y(1)
    gamma_t = ball%tangential_damping*gamma_n
    k_t = 8*ball%modulus/(2*(1 + ball%poisson)*(2 - ball%poisson))*a
    point = y(2) - y(3)*(1 - delta/ball%radius)
  end subroutine contact_of

  pure function rate(ball, y) result(slope)
    type(hertz_ball_t), intent(in) :: ball
    real(wp), intent(in) :: y(5)
    real(wp) :: slope(5)

    real(wp) :: point, f_n, f_t, gamma_t, k_t

    call contact_of(ball, y, point, f_n, gamma_t, k_t)
    f_t = -k_t*y(5) - gamma_t*point
    if (abs(f_t) > ball%friction*abs(f_n)) f_t = sign(ball%friction*abs(f_n), f_t)
    slope = [f_n/mass(ball), f_t/mass(ball), -2.5_wp*f_t/mass(ball)*(1 - max(y(4), 0.0_wp)/ball%radius), -y(1), point]
  end function rate

  !> The slip, cut back where the contact slides [m].
  pure function held_slip(ball, y) result(xi)
    type(hertz_ball_t), intent(in) :: ball
    real(wp), intent(in) :: y(5)
    real(wp) :: xi

    real(wp) :: point, f_n, f_t, gamma_t, k_t

    call contact_of(ball, y, point, f_n, gamma_t, k_t)
    f_t = -k_t*y(5) - gamma_t*point
    xi = y(5)
    if (abs(f_t) > ball%friction*abs(f_n)) xi = -(sign(ball%friction*abs(f_n), f_t) + gamma_t*point)/k_t
  end function held_slip

end module hertz_contact
