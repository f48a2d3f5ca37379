!> Linear spring-dashpot contacts, with Coulomb friction and rotation or without both.
!>
!>   normal      F_n = k_n delta - gamma_n v_n,  gamma_n = 2 sqrt(k_n m_eff) |ln e| / sqrt(pi^2 + ln^2 e)
!>   tangential  F_t = -k_t xi - gamma_t v_t,    |F_t| <= mu |F_n|
!>
!> delta is the overlap, the normal n points from the partner to this parcel, and the slip xi is turned into
!> the present tangent plane before it grows. The damping follows from the pair's own m_eff, so that every
!> pair has the restitution asked for.
!> Source: Cundall & Strack, Geotechnique 29 (1979) 47-65, for the model; Luding, Granular Matter 10 (2008)
!>         235-246, sec. 2.3, for xi; restitution of a damped oscillator: Schaefer, Dippel & Wolf,
!>         J. Phys. I France 6 (1996) 5-20, sec. 3.1.
!>
!> The contact point divides the distance d of the centres as the radii: arms r d/(r_i + r_j). Then torques
!> and forces together conserve angular momentum exactly.
!>
!> A step makes the period of an oscillator too short by 1/24 (omega_0 dt)^2, omega_0^2 = k_n/m_eff, so springs are softer by
!> (1/12 - 2/3 zeta) (omega_0 dt)^2: an elastic collision of two is right to fourth order. Velocities are those of the moment of the
!> positions: see motion. Their extrapolation damps too much, so dashpots are multiplied by 1 - q + q^2 with
!> q = (1/2 + 4/5 zeta - 3/2 zeta^2) (omega_0 dt)^2. What zeta is multiplied by was found by trial: at 20 steps in a collision
!> the restitution is right to 0.05 % for e of 0.3 and above, 0.1 % at 0.2, 1 % at 0.1, and balls with several damped contacts at
!> once move as they should.
!>
!> A dashpot sets in at full strength, so a step in which a contact begins or ends must count it for as long as the contact
!> lasts. Of a pair whose overlap is less than what it has moved since the step before, or will move until the next, this is the
!> first or the last step that finds it touching: it stands for the half of the step on the one side and for the time delta/v
!> on the other, 1/2 + delta/(v dt) steps of the dashpot. Not so the tangential one, of which the slip keeps account.
module contact_linear
  use constants, only: pi
  use contact_lanes, only: lanes, group_of, record_rows, turn_eight, turn_four
  use kinds, only: wp
  implicit none
  private
  public :: linear_t, new_linear, damping_ratio, linear_friction_forces, linear_frictionless_forces

  real(wp), parameter :: least = 1.0e-100_wp  !< below any way [m] and force [N]; its square is a number

  !> Constants of one pair of materials.
  type :: linear_t
    real(wp) :: k_n = 0.0_wp          !< normal stiffness [N/m]
    real(wp) :: k_t = 0.0_wp          !< tangential stiffness [N/m]
    real(wp) :: per_k_t = 0.0_wp      !< 1/k_t [m/N]
    real(wp) :: damping = 0.0_wp      !< gamma_n / sqrt(m_eff) [sqrt(N/m)]
    real(wp) :: tangential = 0.0_wp   !< gamma_t / gamma_n [-]
    real(wp) :: mu = 0.0_wp           !< Coulomb friction [-]
    real(wp) :: softening = 0.0_wp    !< of springs over (omega_0 dt)^2, see above [-]
    real(wp) :: weakening = 0.0_wp    !< q of dashpots over (omega_0 dt)^2 [-]
    real(wp) :: dt = 0.0_wp           !< time step [s]
    real(wp) :: excess = 0.0_wp       !< q, by which it damps too much, over 1/m_eff [kg]
    real(wp) :: soft = 0.0_wp         !< by which springs are softer, over 1/m_eff [kg]
  contains
    procedure :: set_step
    procedure :: contact_time
  end type linear_t

contains

  pure function new_linear(k_n, tangential_ratio, restitution, tangential_damping, mu) result(law)
    real(wp), intent(in) :: k_n                 !< [N/m]
    real(wp), intent(in) :: tangential_ratio    !< k_t/k_n [-]
    real(wp), intent(in) :: restitution         !< e_n [-]
    real(wp), intent(in) :: tangential_damping  !< gamma_t/gamma_n [-]
    real(wp), intent(in) :: mu                  !< [-]
    type(linear_t) :: law

    law%k_n = k_n
    law%k_t = k_n*tangential_ratio
    if (law%k_t > 0.0_wp) law%per_k_t = 1/law%k_t
    law%damping = 2*sqrt(k_n)*damping_ratio(restitution)
    associate (zeta => damping_ratio(restitution))
      law%softening = 1.0_wp/12.0_wp - 2.0_wp/3.0_wp*zeta
      law%weakening = 0.5_wp + 0.8_wp*zeta - 1.5_wp*zeta**2
    end associate
    law%tangential = tangential_damping
    law%mu = mu
  end function new_linear

  !> Damping over critical damping, zeta = |ln e| / sqrt(pi^2 + ln^2 e).
  elemental function damping_ratio(restitution) result(zeta)
    real(wp), intent(in) :: restitution
    real(wp) :: zeta

    zeta = abs(log(restitution))/sqrt(pi**2 + log(restitution)**2)
  end function damping_ratio

  !> The length of the steps that follow.
  elemental subroutine set_step(self, dt)
    class(linear_t), intent(inout) :: self
    real(wp), intent(in) :: dt  !< [s]

    self%dt = dt
    self%excess = self%weakening*self%k_n*dt**2
    self%soft = self%softening*self%k_n*dt**2
  end subroutine set_step

  !> Time a collision takes, pi/(omega_0 sqrt(1 - zeta^2)) with omega_0^2 = k_n/m_eff [s].
  pure function contact_time(self, effective_mass)
    class(linear_t), intent(in) :: self
    real(wp), intent(in) :: effective_mass  !< [kg]
    real(wp) :: contact_time

    contact_time = pi*sqrt(effective_mass)/sqrt(self%k_n - (self%damping/2)**2)
  end function contact_time

  !> Forces of n pairs (i, j) with friction, n a multiple of `lanes`; none on those that do not touch, whose slip becomes zero.
  !>
  !> `pair` holds of each pair: 1:3 x_i - x_j, 4 r_i + r_j, 5:7 v_i - v_j, 8 1/m_i + 1/m_j; `spin` holds 1:3
  !> r_i omega_i + r_j omega_j, and in 4 what other laws read; `force` receives 1:3 the force on i and 5:7 the
  !> torque over radius, the same for i and j. Exchanging i and j gives exactly the opposite force.
  pure subroutine linear_friction_forces(law, n, pair, spin, record, force)
    type(linear_t), intent(in) :: law
    integer, intent(in) :: n
    real(wp), intent(in) :: pair(8, n)     !< [m], [m], [m/s], [1/kg]
    real(wp), intent(in) :: spin(4, n)     !< [m/s]
    real(wp), intent(inout) :: record(lanes, record_rows, n/lanes)  !< see contact_lanes
    real(wp), intent(out) :: force(8, n)   !< [N]

    real(wp) :: forces(lanes, 8)
    integer :: k

    do k = 1, n, lanes
      call eight_with_friction(law, pair(:, k:k + lanes - 1), spin(:, k:k + lanes - 1), record(:, :, group_of(k)), forces)
      call turn_eight(forces, force(:, k:k + lanes - 1))
    end do
  end subroutine linear_friction_forces

  !> Eight pairs at once, one in each lane. All rows are read, since one left out would keep the last lanes out
  !> of the vector loop; forces are written lane by lane and turned afterwards, which is 9 % faster. Several short loops
  !> are 9 % faster than a long one: a root or a division of one vector does not wait for the next steps of another. These two are
  !> what a pair waits for, so one division serves all that the force on it is divided by.
  pure subroutine eight_with_friction(law, pair, spin, record, forces)
    type(linear_t), intent(in) :: law
    real(wp), intent(in) :: pair(8, lanes), spin(4, lanes)
    real(wp), intent(inout) :: record(lanes, record_rows)
    real(wp), intent(out) :: forces(lanes, 8)

    real(wp), dimension(lanes) :: x, y, z, per_d, delta, gamma_n, v_n, u, v, w, inverse, f_n, way
    real(wp), dimension(lanes) :: t_x, t_y, t_z, a, b, c, f_x, f_y, f_z, gamma_t, touch
    real(wp) :: square, q, push, next, part, along, trial, share, cap, back
    integer :: k

    ! Distance, and dashpots.
    !$omp simd simdlen(8) private(square, q)
    do k = 1, lanes
      x(k) = pair(1, k)
      y(k) = pair(2, k)
      z(k) = pair(3, k)
      square = x(k)*x(k) + y(k)*y(k) + z(k)*z(k)
      touch(k) = 0.5_wp - sign(0.5_wp, square - pair(4, k)*pair(4, k))  ! a condition could split the loop
      per_d(k) = 1/sqrt(square)
      delta(k) = max(pair(4, k) - square*per_d(k), 0.0_wp)
      q = law%excess*pair(8, k)
      gamma_n(k) = law%damping*record(k, 4)*(1 - q*(1 - q))
      u(k) = pair(5, k)
      v(k) = pair(6, k)
      w(k) = pair(7, k)
      inverse(k) = pair(8, k)
    end do

    ! Normal force times `way`; its dashpot as long as the contact lasts in this step.
    !$omp simd simdlen(8) private(push, next)
    do k = 1, lanes
      v_n(k) = (u(k)*x(k) + v(k)*y(k) + w(k)*z(k))*per_d(k)
      gamma_n(k) = touch(k)*gamma_n(k)
      gamma_t(k) = law%tangential*gamma_n(k)
      push = touch(k)*law%k_n*delta(k)*(1 - law%soft*inverse(k))
      next = v_n(k) + 0.5_wp*law%dt*inverse(k)*(push - gamma_n(k)*v_n(k))
      way(k) = law%dt*merge(next, -v_n(k), next > -v_n(k))
      way(k) = max(merge(way(k), delta(k), way(k) > delta(k)), least)
      f_n(k) = push*way(k) - gamma_n(k)*(delta(k) + merge(0.5_wp, 0.0_wp, delta(k) < way(k))*way(k))*v_n(k)
    end do

    ! Velocity at the contact point without its normal part, and the slip since the contact began, kept in the tangent plane.
    !$omp simd simdlen(8) private(part, along)
    do k = 1, lanes
      part = v_n(k)*per_d(k)
      t_x(k) = u(k) - x(k)*part - (spin(2, k)*z(k) - spin(3, k)*y(k))*record(k, 5)
      t_y(k) = v(k) - y(k)*part - (spin(3, k)*x(k) - spin(1, k)*z(k))*record(k, 5)
      t_z(k) = w(k) - z(k)*part - (spin(1, k)*y(k) - spin(2, k)*x(k))*record(k, 5)
      a(k) = record(k, 1) + t_x(k)*law%dt
      b(k) = record(k, 2) + t_y(k)*law%dt
      c(k) = record(k, 3) + t_z(k)*law%dt
      along = (a(k)*x(k) + b(k)*y(k) + c(k)*z(k))*per_d(k)*per_d(k)
      a(k) = a(k) - along*x(k)
      b(k) = b(k) - along*y(k)
      c(k) = c(k) - along*z(k)
      forces(k, 8) = spin(4, k)
    end do

    ! Trial force, capped at mu |F_n|; where it slides the slip is what the spring alone would need.
    !$omp simd simdlen(8) private(trial, share, cap, back)
    do k = 1, lanes
      f_x(k) = -(law%k_t*a(k) + gamma_t(k)*t_x(k))
      f_y(k) = -(law%k_t*b(k) + gamma_t(k)*t_y(k))
      f_z(k) = -(law%k_t*c(k) + gamma_t(k)*t_z(k))
      trial = sqrt(max(f_x(k)*f_x(k) + f_y(k)*f_y(k) + f_z(k)*f_z(k), least**2))
      share = 1/(way(k)*trial)
      cap = min(law%mu*abs(f_n(k))*share, 1.0_wp)
      f_n(k) = f_n(k)*share*trial
      back = gamma_t(k)*law%per_k_t*(cap - 1)
      record(k, 1) = cap*a(k) + back*t_x(k)
      record(k, 2) = cap*b(k) + back*t_y(k)
      record(k, 3) = cap*c(k) + back*t_z(k)
      f_x(k) = cap*f_x(k)
      f_y(k) = cap*f_y(k)
      f_z(k) = cap*f_z(k)
    end do

    ! Force on i, and torque over radius.
    !$omp simd simdlen(8) private(part)
    do k = 1, lanes
      part = f_n(k)*per_d(k)
      forces(k, 1) = f_x(k) + x(k)*part
      forces(k, 2) = f_y(k) + y(k)*part
      forces(k, 3) = f_z(k) + z(k)*part
      forces(k, 4) = 0.0_wp
      forces(k, 5) = (z(k)*f_y(k) - y(k)*f_z(k))*record(k, 5)
      forces(k, 6) = (x(k)*f_z(k) - z(k)*f_x(k))*record(k, 5)
      forces(k, 7) = (y(k)*f_x(k) - x(k)*f_y(k))*record(k, 5)
    end do
  end subroutine eight_with_friction

  !> The same without friction; `force` receives 1:3 the force on i.
  pure subroutine linear_frictionless_forces(law, n, pair, force)
    type(linear_t), intent(in) :: law
    integer, intent(in) :: n
    real(wp), intent(in) :: pair(8, n)    !< [m], [m], [m/s], [1/kg]
    real(wp), intent(out) :: force(4, n)  !< 1:3 force on i [N]

    real(wp) :: forces(lanes, 4)
    integer :: k

    do k = 1, n, lanes
      call eight_without_friction(law, pair(:, k:k + lanes - 1), forces)
      call turn_four(forces, force(:, k:k + lanes - 1))
    end do
  end subroutine linear_frictionless_forces

  pure subroutine eight_without_friction(law, pair, forces)
    type(linear_t), intent(in) :: law
    real(wp), intent(in) :: pair(8, lanes)
    real(wp), intent(out) :: forces(lanes, 4)

    real(wp) :: square, per_d, delta, q, gamma_n, v_n, f_n, push, way, part, next
    integer :: k

    !$omp simd simdlen(8) private(square, per_d, push, delta, next, way, part, q, gamma_n, v_n, f_n)
    do k = 1, lanes
      square = pair(1, k)*pair(1, k) + pair(2, k)*pair(2, k) + pair(3, k)*pair(3, k)
      per_d = 1/sqrt(square)
      v_n = (pair(5, k)*pair(1, k) + pair(6, k)*pair(2, k) + pair(7, k)*pair(3, k))*per_d
      delta = pair(4, k) - square*per_d
      q = law%excess*pair(8, k)
      gamma_n = law%damping/sqrt(pair(8, k))*(1 - q*(1 - q))
      push = law%k_n*delta*(1 - law%soft*pair(8, k))
      next = v_n + 0.5_wp*law%dt*pair(8, k)*(push - gamma_n*v_n)
      way = law%dt*merge(next, -v_n, next > -v_n)
      part = delta/max(merge(way, delta, way > delta), least)
      gamma_n = gamma_n*(part + merge(0.5_wp, 0.0_wp, part < 1.0_wp))
      f_n = merge(1.0_wp, 0.0_wp, square < pair(4, k)*pair(4, k))*(push - gamma_n*v_n)*per_d
      forces(k, 1) = pair(1, k)*f_n
      forces(k, 2) = pair(2, k)*f_n
      forces(k, 3) = pair(3, k)*f_n
      forces(k, 4) = 0.0_wp
    end do
  end subroutine eight_without_friction

end module contact_linear
