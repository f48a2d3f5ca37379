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
!> Velocities are those of the moment of the positions: see motion. Their extrapolation makes the velocity of an oscillator too
!> large by 3/8 (omega_0 dt)^2 and the step its period too short by 1/24 of the same, so dashpots are divided by 1 + (5/12 +
!> zeta) (omega_0 dt)^2, omega_0^2 = k_n/m_eff; the zeta, for heavier damping, is found by trial. At 20 steps in a collision the
!> restitution is then right to 0.1 % for e of 0.5 and above, 1 % at 0.3.
!>
!> A dashpot sets in at full strength, so a step in which a contact begins or ends must count it for as long as the contact
!> lasts. Of a pair whose overlap is less than what it has moved since the step before, or will move until the next, this is the
!> first or the last step that finds it touching: it stands for the half of the step on the one side and for the time delta/v
!> on the other, 1/2 + delta/(v dt) steps of the dashpot. Not so the tangential one, of which the slip keeps account.
module contact_linear
  use constants, only: pi
  use contact_lanes, only: lanes, turn_eight, turn_four
  use kinds, only: wp
  implicit none
  private
  public :: linear_t, new_linear, damping_ratio, lead_excess, linear_friction_forces, linear_frictionless_forces

  !> Constants of one pair of materials.
  type :: linear_t
    real(wp) :: k_n = 0.0_wp          !< normal stiffness [N/m]
    real(wp) :: k_t = 0.0_wp          !< tangential stiffness [N/m]
    real(wp) :: per_k_t = 0.0_wp      !< 1/k_t [m/N]
    real(wp) :: damping = 0.0_wp      !< gamma_n / sqrt(m_eff) [sqrt(N/m)]
    real(wp) :: excess = 0.0_wp       !< by which a step damps too much, over dt^2/m_eff [N/m]
    real(wp) :: tangential = 0.0_wp   !< gamma_t / gamma_n [-]
    real(wp) :: mu = 0.0_wp           !< Coulomb friction [-]
    real(wp) :: dt = 0.0_wp           !< time step [s]
    real(wp) :: step = 0.0_wp         !< number of this step
  contains
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
    law%excess = lead_excess(restitution)*k_n
    law%tangential = tangential_damping
    law%mu = mu
  end function new_linear

  !> Damping over critical damping, zeta = |ln e| / sqrt(pi^2 + ln^2 e).
  elemental function damping_ratio(restitution) result(zeta)
    real(wp), intent(in) :: restitution
    real(wp) :: zeta

    zeta = abs(log(restitution))/sqrt(pi**2 + log(restitution)**2)
  end function damping_ratio

  !> By which share velocities with a lead damp too much, over (omega_0 dt)^2: see above.
  elemental function lead_excess(restitution) result(excess)
    real(wp), intent(in) :: restitution
    real(wp) :: excess

    excess = 5.0_wp/12.0_wp + damping_ratio(restitution)
  end function lead_excess

  !> Time a collision takes, pi/(omega_0 sqrt(1 - zeta^2)) with omega_0^2 = k_n/m_eff [s].
  pure function contact_time(self, effective_mass)
    class(linear_t), intent(in) :: self
    real(wp), intent(in) :: effective_mass  !< [kg]
    real(wp) :: contact_time

    contact_time = pi*sqrt(effective_mass)/sqrt(self%k_n - (self%damping/2)**2)
  end function contact_time

  !> Forces of n touching pairs (i, j) with friction, n a multiple of `lanes`.
  !>
  !> `pair` holds of each pair: 1:3 x_i - x_j, 4 r_i + r_j, 5:7 v_i - v_j, 8 1/m_i + 1/m_j; `spin` holds 1:3
  !> r_i omega_i + r_j omega_j, and in 4 what other laws read; `force` receives 1:3 the force on i and 5:7 the
  !> torque over radius, the same for i and j. Exchanging i and j gives exactly the opposite force.
  pure subroutine linear_friction_forces(law, n, pair, spin, slip, force)
    type(linear_t), intent(in) :: law
    integer, intent(in) :: n
    real(wp), intent(in) :: pair(8, n)     !< [m], [m], [m/s], [1/kg]
    real(wp), intent(in) :: spin(4, n)     !< [m/s]
    real(wp), intent(inout) :: slip(4, n)  !< 1:3 tangential slip [m], 4 step of the last touch
    real(wp), intent(out) :: force(8, n)   !< [N]

    real(wp) :: forces(lanes, 8), slips(lanes, 4)
    integer :: k

    do k = 1, n, lanes
      call eight_with_friction(law, pair(:, k:k + lanes - 1), spin(:, k:k + lanes - 1), &
                               slip(:, k:k + lanes - 1), forces, slips)
      call turn_eight(forces, force(:, k:k + lanes - 1))
      call turn_four(slips, slip(:, k:k + lanes - 1))
    end do
  end subroutine linear_friction_forces

  !> Eight pairs at once, one in each lane. All rows are read, since one left out would keep the last lanes out
  !> of the vector loop; results are written lane by lane and turned afterwards, which is 9 % faster.
  pure subroutine eight_with_friction(law, pair, spin, slip, forces, slips)
    type(linear_t), intent(in) :: law
    real(wp), intent(in) :: pair(8, lanes), spin(4, lanes), slip(4, lanes)
    real(wp), intent(out) :: forces(lanes, 8), slips(lanes, 4)

    real(wp) :: x, y, z, reach, square, per_d, d, q, share, per_reach, gamma_n, v_n, f_n, part, excess, way, delta, next
    real(wp) :: t_x, t_y, t_z, a, b, c, along, gamma_t, f_x, f_y, f_z, cap, back, keep
    integer :: k

    excess = law%excess*law%dt**2
    !$omp simd simdlen(8) private(x, y, z, reach, delta, next, way, square, per_d, d, q, share, per_reach, gamma_n, v_n) &
    !$omp& private(f_n, part, t_x, t_y, t_z, a, b, c, along, gamma_t, f_x, f_y, f_z, cap, back, keep)
    do k = 1, lanes
      x = pair(1, k)
      y = pair(2, k)
      z = pair(3, k)
      reach = pair(4, k)
      square = x*x + y*y + z*z
      per_d = 1/sqrt(square)
      d = square*per_d

      ! Dashpots: gamma_n = damping sqrt(m_eff)/(1 + excess/m_eff), one division for it and 1/reach.
      q = sqrt(pair(8, k))*(1 + excess*pair(8, k))
      share = 1/(q*reach)
      per_reach = share*q
      v_n = (pair(5, k)*x + pair(6, k)*y + pair(7, k)*z)*per_d
      gamma_n = law%damping*share*reach
      gamma_t = law%tangential*gamma_n
      delta = reach - d
      next = v_n + 0.5_wp*law%dt*pair(8, k)*(law%k_n*delta - gamma_n*v_n)
      way = law%dt*merge(next, -v_n, next > -v_n)
      part = delta/max(merge(way, delta, way > delta), tiny(way))
      gamma_n = gamma_n*(part + merge(0.5_wp, 0.0_wp, part < 1.0_wp))

      ! Normal force, and the velocity at the contact point without its normal part.
      f_n = law%k_n*delta - gamma_n*v_n
      part = v_n*per_d
      t_x = pair(5, k) - x*part - (spin(2, k)*z - spin(3, k)*y)*per_reach
      t_y = pair(6, k) - y*part - (spin(3, k)*x - spin(1, k)*z)*per_reach
      t_z = pair(7, k) - z*part - (spin(1, k)*y - spin(2, k)*x)*per_reach

      ! Slip since the contact began, kept in the tangent plane.
      keep = merge(1.0_wp, 0.0_wp, slip(4, k) >= law%step - 1.5_wp)
      a = keep*slip(1, k) + t_x*law%dt
      b = keep*slip(2, k) + t_y*law%dt
      c = keep*slip(3, k) + t_z*law%dt
      along = (a*x + b*y + c*z)*per_d*per_d
      a = a - along*x
      b = b - along*y
      c = c - along*z

      ! Trial force, capped at mu |F_n|; where it slides the slip is what the spring alone would need.
      f_x = -(law%k_t*a + gamma_t*t_x)
      f_y = -(law%k_t*b + gamma_t*t_y)
      f_z = -(law%k_t*c + gamma_t*t_z)
      cap = law%mu*abs(f_n)/sqrt(max(f_x*f_x + f_y*f_y + f_z*f_z, tiny(cap)))
      cap = min(cap, 1.0_wp)
      back = gamma_t*law%per_k_t*(cap - 1)
      slips(k, 1) = cap*a + back*t_x
      slips(k, 2) = cap*b + back*t_y
      slips(k, 3) = cap*c + back*t_z
      slips(k, 4) = law%step
      f_x = cap*f_x
      f_y = cap*f_y
      f_z = cap*f_z

      f_n = f_n*per_d
      forces(k, 1) = f_x + x*f_n
      forces(k, 2) = f_y + y*f_n
      forces(k, 3) = f_z + z*f_n
      forces(k, 4) = 0.0_wp
      forces(k, 5) = (z*f_y - y*f_z)*per_reach
      forces(k, 6) = (x*f_z - z*f_x)*per_reach
      forces(k, 7) = (y*f_x - x*f_y)*per_reach
      forces(k, 8) = spin(4, k)
    end do
  end subroutine eight_with_friction

  !> Forces of n touching pairs without friction, n a multiple of `lanes`; `pair` as in `linear_friction_forces`.
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

    real(wp) :: square, per_d, delta, gamma_n, v_n, f_n, excess, way, part, next
    integer :: k

    excess = law%excess*law%dt**2
    !$omp simd simdlen(8) private(square, per_d, delta, next, way, part, gamma_n, v_n, f_n)
    do k = 1, lanes
      square = pair(1, k)*pair(1, k) + pair(2, k)*pair(2, k) + pair(3, k)*pair(3, k)
      per_d = 1/sqrt(square)
      v_n = (pair(5, k)*pair(1, k) + pair(6, k)*pair(2, k) + pair(7, k)*pair(3, k))*per_d
      delta = pair(4, k) - square*per_d
      gamma_n = law%damping/(sqrt(pair(8, k))*(1 + excess*pair(8, k)))
      next = v_n + 0.5_wp*law%dt*pair(8, k)*(law%k_n*delta - gamma_n*v_n)
      way = law%dt*merge(next, -v_n, next > -v_n)
      part = delta/max(merge(way, delta, way > delta), tiny(way))
      gamma_n = gamma_n*(part + merge(0.5_wp, 0.0_wp, part < 1.0_wp))
      f_n = (law%k_n*delta - gamma_n*v_n)*per_d
      forces(k, 1) = pair(1, k)*f_n
      forces(k, 2) = pair(2, k)*f_n
      forces(k, 3) = pair(3, k)*f_n
      forces(k, 4) = 0.0_wp
    end do
  end subroutine eight_without_friction

end module contact_linear
