!> Hertz contacts, with Mindlin's tangential stiffness, friction and rotation or without all three.
!>
!>   normal      F_n = (4/3) E a delta - gamma_n v_n,   a = sqrt(R delta),   S = dF/d(delta) = 2 E a
!>               gamma_n = sqrt(10/3) zeta sqrt(S m_eff),   zeta = |ln e|/sqrt(pi^2 + ln^2 e)
!>   tangential  F_t = -k_t xi - gamma_t v_t,   k_t = 8 G a,   |F_t| <= mu |F_n|
!>
!> with 1/R = 1/r_i + 1/r_j, 1/E = sum (1 - nu^2)/E_i and 1/G = sum (2 - nu)/G_i over both partners. A damping that
!> goes as delta^(1/4) makes the restitution independent of speed (Tsuji, Tanaka & Ishida, Powder Technol. 71 (1992)
!> 239-250); this one gives exactly the e asked for: Antypov & Elliott, EPL 94 (2011) 50004. As in the linear law the contact
!> lasts until the overlap is gone, so the force attracts shortly before. xi is the slip as a length, which is
!> multiplied by the present stiffness (Di Renzo & Di Maio, Chem. Eng. Sci. 59 (2004) 525-541, sec. 2.3).
!>
!> The contact point is that of contact_linear. Steps damp too much here, too, so dashpots are divided by 1 + (5/12 + zeta)
!> S dt^2/m_eff, found by trial; they set in gently, and springs are as they are.
module contact_hertz
  use contact_lanes, only: lanes, group_of, record_rows, turn_eight, turn_four
  use contact_linear, only: damping_ratio
  use kinds, only: wp
  implicit none
  private
  public :: hertz_t, new_hertz, elastic_t, hertz_friction_forces, hertz_frictionless_forces

  !> Elastic constants of one material.
  type :: elastic_t
    real(wp) :: modulus = 0.0_wp  !< Young's [Pa]
    real(wp) :: poisson = 0.0_wp  !< Poisson's ratio [-]
  end type elastic_t

  !> Constants of one pair of materials.
  type :: hertz_t
    real(wp) :: modulus = 0.0_wp      !< effective Young's modulus E [Pa]
    real(wp) :: shear = 0.0_wp        !< k_t/S = 4 G/E [-]
    real(wp) :: damping = 0.0_wp      !< gamma_n / sqrt(S m_eff) [-]
    real(wp) :: excess = 0.0_wp       !< by which a step damps too much, over S dt^2/m_eff [-]
    real(wp) :: tangential = 0.0_wp   !< gamma_t / gamma_n [-]
    real(wp) :: mu = 0.0_wp           !< Coulomb friction [-]
    real(wp) :: dt = 0.0_wp           !< time step [s]
  contains
    procedure :: contact_time
  end type hertz_t

contains

  pure function new_hertz(one, other, restitution, tangential_damping, mu) result(law)
    type(elastic_t), intent(in) :: one, other
    real(wp), intent(in) :: restitution         !< e_n [-]
    real(wp), intent(in) :: tangential_damping  !< gamma_t/gamma_n [-]
    real(wp), intent(in) :: mu                  !< [-]
    type(hertz_t) :: law

    law%modulus = 1/(compliance(one) + compliance(other))
    law%shear = 4/(law%modulus*(shear_compliance(one) + shear_compliance(other)))
    law%damping = sqrt(10.0_wp/3.0_wp)*damping_ratio(restitution)
    law%excess = 5.0_wp/12.0_wp + damping_ratio(restitution)
    law%tangential = tangential_damping
    law%mu = mu
  end function new_hertz

  !> (1 - nu^2)/E [1/Pa]
  pure function compliance(material)
    type(elastic_t), intent(in) :: material
    real(wp) :: compliance

    compliance = (1 - material%poisson**2)/material%modulus
  end function compliance

  !> (2 - nu)/G with G = E/(2 (1 + nu)) [1/Pa]
  pure function shear_compliance(material)
    type(elastic_t), intent(in) :: material
    real(wp) :: shear_compliance

    shear_compliance = 2*(1 + material%poisson)*(2 - material%poisson)/material%modulus
  end function shear_compliance

  !> Time an undamped collision takes [s]. With delta_max = (15 m v^2/(16 E sqrt(R)))^(2/5) it is delta_max/v times
  !> 2 times the integral of dx/sqrt(1 - x^(5/2)) from 0 to 1: Timoshenko & Goodier, Theory of Elasticity, sec. 142.
  elemental function contact_time(self, effective_mass, effective_radius, speed) result(time)
    class(hertz_t), intent(in) :: self
    real(wp), intent(in) :: effective_mass    !< [kg]
    real(wp), intent(in) :: effective_radius  !< [m]
    real(wp), intent(in) :: speed             !< of the approach [m/s]
    real(wp) :: time

    real(wp), parameter :: integral = 4*sqrt(acos(-1.0_wp))*gamma(0.4_wp)/(5*gamma(0.9_wp))

    time = integral*(15*effective_mass*speed**2/(16*self%modulus*sqrt(effective_radius)))**0.4_wp/speed
  end function contact_time

  !> Forces of n pairs with friction, as `friction_forces` of contact_linear; `spin` holds the curvature
  !> 1/r_i + 1/r_j in 4.
  pure subroutine hertz_friction_forces(law, n, pair, spin, record, force)
    type(hertz_t), intent(in) :: law
    integer, intent(in) :: n
    real(wp), intent(in) :: pair(8, n)     !< [m], [m], [m/s], [1/kg]
    real(wp), intent(in) :: spin(4, n)     !< [m/s], 4 [1/m]
    real(wp), intent(inout) :: record(lanes, record_rows, n/lanes)  !< see contact_lanes
    real(wp), intent(out) :: force(8, n)   !< [N]

    real(wp) :: forces(lanes, 8)
    integer :: k

    do k = 1, n, lanes
      call eight_with_friction(law, pair(:, k:k + lanes - 1), spin(:, k:k + lanes - 1), record(:, :, group_of(k)), forces)
      call turn_eight(forces, force(:, k:k + lanes - 1))
    end do
  end subroutine hertz_friction_forces

  !> Eight pairs at once, one in each lane.
  pure subroutine eight_with_friction(law, pair, spin, record, forces)
    type(hertz_t), intent(in) :: law
    real(wp), intent(in) :: pair(8, lanes), spin(4, lanes)
    real(wp), intent(inout) :: record(lanes, record_rows)
    real(wp), intent(out) :: forces(lanes, 8)

    real(wp) :: x, y, z, square, per_d, per_reach, delta, s, gamma_n, v_n, f_n, part, k_t, excess
    real(wp) :: t_x, t_y, t_z, a, b, c, along, gamma_t, f_x, f_y, f_z, cap, back, touch
    integer :: k

    excess = law%excess*law%dt**2
    !$omp simd simdlen(8) private(x, y, z, square, per_d, per_reach, delta, s, gamma_n, v_n, f_n, part, k_t) &
    !$omp& private(t_x, t_y, t_z, a, b, c, along, gamma_t, f_x, f_y, f_z, cap, back, touch)
    do k = 1, lanes
      x = pair(1, k)
      y = pair(2, k)
      z = pair(3, k)
      square = x*x + y*y + z*z
      touch = 0.5_wp - sign(0.5_wp, square - pair(4, k)*pair(4, k))  ! a condition could split the loop
      per_d = 1/sqrt(square)
      per_reach = record(k, 5)

      ! Normal force. Rounding may leave a pair that just touches without overlap.
      delta = max(pair(4, k) - square*per_d, tiny(delta))
      s = 2*law%modulus*sqrt(delta/spin(4, k))
      gamma_n = touch*law%damping*sqrt(s)*record(k, 4)/(1 + excess*s*pair(8, k))
      v_n = (pair(5, k)*x + pair(6, k)*y + pair(7, k)*z)*per_d
      f_n = (2.0_wp/3.0_wp)*s*delta - gamma_n*v_n
      k_t = law%shear*s
      gamma_t = law%tangential*gamma_n

      ! Velocity at the contact point without its normal part.
      part = v_n*per_d
      t_x = pair(5, k) - x*part - (spin(2, k)*z - spin(3, k)*y)*per_reach
      t_y = pair(6, k) - y*part - (spin(3, k)*x - spin(1, k)*z)*per_reach
      t_z = pair(7, k) - z*part - (spin(1, k)*y - spin(2, k)*x)*per_reach

      ! Slip since the contact began, kept in the tangent plane.
      a = record(k, 1) + t_x*law%dt
      b = record(k, 2) + t_y*law%dt
      c = record(k, 3) + t_z*law%dt
      along = (a*x + b*y + c*z)*per_d*per_d
      a = a - along*x
      b = b - along*y
      c = c - along*z

      ! Trial force, capped at mu |F_n|; where it slides the slip is what the spring alone would need.
      f_x = -(k_t*a + gamma_t*t_x)
      f_y = -(k_t*b + gamma_t*t_y)
      f_z = -(k_t*c + gamma_t*t_z)
      cap = law%mu*abs(f_n)/sqrt(max(f_x*f_x + f_y*f_y + f_z*f_z, tiny(cap)))
      cap = min(cap, 1.0_wp)
      back = gamma_t/k_t*(cap - 1)
      record(k, 1) = cap*a + back*t_x
      record(k, 2) = cap*b + back*t_y
      record(k, 3) = cap*c + back*t_z
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
      forces(k, 8) = 0.0_wp
    end do
  end subroutine eight_with_friction

  !> Forces of n pairs without friction, as those with it; `pair` as in `hertz_friction_forces`.
  pure subroutine hertz_frictionless_forces(law, n, pair, curvature, force)
    type(hertz_t), intent(in) :: law
    integer, intent(in) :: n
    real(wp), intent(in) :: pair(8, n)     !< [m], [m], [m/s], [1/kg]
    real(wp), intent(in) :: curvature(n)   !< 1/r_i + 1/r_j [1/m]
    real(wp), intent(out) :: force(4, n)   !< 1:3 force on i [N]

    real(wp) :: forces(lanes, 4)
    integer :: k

    do k = 1, n, lanes
      call eight_without_friction(law, pair(:, k:k + lanes - 1), curvature(k:k + lanes - 1), forces)
      call turn_four(forces, force(:, k:k + lanes - 1))
    end do
  end subroutine hertz_frictionless_forces

  pure subroutine eight_without_friction(law, pair, curvature, forces)
    type(hertz_t), intent(in) :: law
    real(wp), intent(in) :: pair(8, lanes), curvature(lanes)
    real(wp), intent(out) :: forces(lanes, 4)

    real(wp) :: square, per_d, delta, s, gamma_n, v_n, f_n, excess
    integer :: k

    excess = law%excess*law%dt**2
    !$omp simd simdlen(8) private(square, per_d, delta, s, gamma_n, v_n, f_n)
    do k = 1, lanes
      square = pair(1, k)*pair(1, k) + pair(2, k)*pair(2, k) + pair(3, k)*pair(3, k)
      per_d = 1/sqrt(square)
      delta = max(pair(4, k) - square*per_d, tiny(delta))
      s = 2*law%modulus*sqrt(delta/curvature(k))
      gamma_n = law%damping*sqrt(s/pair(8, k))/(1 + excess*s*pair(8, k))
      v_n = (pair(5, k)*pair(1, k) + pair(6, k)*pair(2, k) + pair(7, k)*pair(3, k))*per_d
      f_n = merge(1.0_wp, 0.0_wp, square < pair(4, k)*pair(4, k))*((2.0_wp/3.0_wp)*s*delta - gamma_n*v_n)*per_d
      forces(k, 1) = pair(1, k)*f_n
      forces(k, 2) = pair(2, k)*f_n
      forces(k, 3) = pair(3, k)*f_n
      forces(k, 4) = 0.0_wp
    end do
  end subroutine eight_without_friction

end module contact_hertz
