!> Hertz's law in the tests 1, 2, 3, 5 and 6 of Chung & Ooi, Granul. Matter 13 (2011) 643-656; restitution of unlike pairs.
program verify_hertz
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use check, only: finish
  use chung_ooi, only: aluminium_beta, finite_elements, hertz_impacts, nylon_beta, polyethylene_slip, polyethylene_spin, &
    steel_slip, steel_spin
  use contact_settings, only: contact_settings_t
  use hertz_contact, only: hertz_ball_t, rebound
  use impacts, only: bounced, impact_t, material, met, rigid
  use kinds, only: wp
  use report, only: check_value, point
  implicit none

  !> Radius, density, modulus, Poisson's ratio, restitution, friction, tangential over normal damping.
  type(hertz_ball_t), parameter :: steel = hertz_ball_t(1.0e-5_wp, 7850.0_wp, 2.08e11_wp, 0.3_wp, 1.0_wp, 0.3_wp, 0.5_wp)
  type(hertz_ball_t), parameter :: polyethylene = hertz_ball_t(1.0e-5_wp, 1400.0_wp, 1.0e9_wp, 0.4_wp, 1.0_wp, 0.3_wp, 0.5_wp)
  type(hertz_ball_t), parameter :: aluminium = hertz_ball_t(0.1_wp, 2700.0_wp, 7.0e10_wp, 0.33_wp, 0.5_wp, 0.4_wp, 0.0_wp)
  type(hertz_ball_t), parameter :: nylon = hertz_ball_t(0.1_wp, 1000.0_wp, 2.5e9_wp, 0.4_wp, 0.5_wp, 0.4_wp, 0.0_wp)
  type(communicator_t) :: comm

  call start_ranks(comm)
  call equal_spheres()
  call rigid_plane()
  call restitutions()
  call oblique('steel', steel, steel_slip, steel_spin)
  call oblique('polyethylene', polyethylene, polyethylene_slip, polyethylene_spin)
  call against_finite_elements(steel)
  call spinning('aluminium', aluminium, aluminium_beta)
  call spinning('nylon', nylon, nylon_beta)
  call finish()
  call stop_ranks()

contains

  !> Test 1: two spheres of 10 mm radius meet at 10 m/s each.
  subroutine equal_spheres()
    real(wp), parameter :: r = 0.01_wp

    call check_impact('hertz_glass', met(comm, [r, r], 2800.0_wp, 20.0_wp, material(4.8e10_wp, 0.2_wp, 1.0_wp, 0.35_wp)), 1)
    call check_impact('hertz_limestone', met(comm, [r, r], 2500.0_wp, 20.0_wp, material(2.0e10_wp, 0.25_wp, 1.0_wp, 0.35_wp)), 2)
  end subroutine equal_spheres

  !> Test 2: a sphere of 0.1 m radius meets a rigid plane at 0.2 m/s.
  subroutine rigid_plane()
    type(impact_t) :: impact
    real(wp), parameter :: r = 0.1_wp, velocity(3) = [0.0_wp, 0.0_wp, -0.2_wp]

    call bounced(comm, r, 2699.0_wp, velocity, on_rigid(material(7.0e10_wp, 0.3_wp, 1.0_wp, 0.0_wp)), impact)
    call check_impact('hertz_aluminium', impact, 3)
    call bounced(comm, r, 1800.0_wp, velocity, on_rigid(material(4.0e10_wp, 0.35_wp, 1.0_wp, 0.0_wp)), impact)
    call check_impact('hertz_magnesium', impact, 4)
  end subroutine rigid_plane

  pure function on_rigid(contact) result(same)
    type(contact_settings_t), intent(in) :: contact
    type(contact_settings_t) :: same

    same = contact
    same%wall_youngs_modulus = rigid
  end function on_rigid

  subroutine check_impact(name, impact, column)
    character(len=*), intent(in) :: name
    type(impact_t), intent(in) :: impact
    integer, intent(in) :: column

    call check_value(name//'_overlap', 1.0e6_wp*impact%overlap, hertz_impacts(1, column))
    call check_value(name//'_force', impact%force, hertz_impacts(2, column))
    call check_value(name//'_duration', 1.0e6_wp*impact%duration, hertz_impacts(3, column))
  end subroutine check_impact

  !> Test 3: restitutions of 0.2 to 1, radius 2.5 mm, aluminium oxide and cast iron at 3.9 m/s and slower; and of
  !> parcels one, two and five times as wide as the other, by either law.
  subroutine restitutions()
    type(impact_t) :: impact
    real(wp), parameter :: speed(3) = [0.02_wp, 0.4_wp, 3.9_wp], ratio(3) = [1.0_wp, 2.0_wp, 5.0_wp]
    type(contact_settings_t) :: linear
    real(wp) :: worst(4), e
    integer :: fifths, k

    worst = 0
    do fifths = 1, 5
      e = 0.2_wp*fifths
      do k = 1, size(speed)
        associate (v => [0.0_wp, 0.0_wp, -speed(k)])
          call bounced(comm, 2.5e-3_wp, 4000.0_wp, v, on_rigid(material(3.8e11_wp, 0.23_wp, e, 0.0_wp)), impact)
          worst(1) = max(worst(1), abs(impact%restitution - e))
          call bounced(comm, 2.5e-3_wp, 7000.0_wp, v, on_rigid(material(1.0e11_wp, 0.25_wp, e, 0.0_wp)), impact)
          worst(2) = max(worst(2), abs(impact%restitution - e))
        end associate
      end do
      linear%stiffness = 1.0e3_wp
      linear%restitution = e
      do k = 1, size(ratio)
        impact = met(comm, 1.0e-3_wp*[1.0_wp, ratio(k)], 2500.0_wp, 0.5_wp, material(1.0e8_wp, 0.3_wp, e, 0.3_wp))
        worst(3) = max(worst(3), abs(impact%restitution - e))
        impact = met(comm, 1.0e-3_wp*[1.0_wp, ratio(k)], 2500.0_wp, 0.5_wp, linear)
        worst(4) = max(worst(4), abs(impact%restitution - e))
      end do
    end do
    call check_value('hertz_restitution_oxide', worst(1), 0.0_wp)
    call check_value('hertz_restitution_iron', worst(2), 0.0_wp)
    call check_value('restitution_hertz_pairs', worst(3), 0.0_wp)
    call check_value('restitution_linear_pairs', worst(4), 0.0_wp)
  end subroutine restitutions

  !> What is left of an impact by the program: normal velocity, velocity along the plane, spin times radius [m/s].
  function computed(ball, v_n, v_t, spin) result(after)
    type(hertz_ball_t), intent(in) :: ball
    real(wp), intent(in) :: v_n, v_t, spin  !< [m/s]
    real(wp) :: after(3)

    type(contact_settings_t) :: contact
    type(impact_t) :: impact

    contact = on_rigid(material(ball%modulus, ball%poisson, ball%restitution, ball%friction))
    contact%tangential_damping_ratio = ball%tangential_damping
    contact%impact_velocity = v_n
    call bounced(comm, ball%radius, ball%density, [v_t, 0.0_wp, -v_n], contact, impact, spin, after(2:3))
    after(1) = impact%restitution*v_n
  end function computed

  !> Test 5: oblique impacts at 5 m/s along the normal, elastic. Against the equations of the law at all angles, and
  !> against the published where they slide throughout, v_t > 7 mu v_n.
  subroutine oblique(name, ball, slip, spin)
    character(len=*), intent(in) :: name
    type(hertz_ball_t), intent(in) :: ball
    real(wp), intent(in) :: slip(:,:), spin(:,:)  !< (2,n): v_t/(mu v_n), and what follows over mu v_n

    real(wp) :: after(3), law, published
    integer :: k

    law = 0
    published = 0
    do k = 1, size(slip, 2)
      after = oblique_impact(ball, slip(1, k), law)
      if (slip(1, k) > 7) published = max(published, abs(after(2) - after(3) - slip(2, k)))
      call point('oblique5_'//name, slip(1, k), after(2) - after(3), slip(2, k))
    end do
    do k = 1, size(spin, 2)
      after = oblique_impact(ball, spin(1, k), law)
      if (spin(1, k) > 7) published = max(published, abs(-after(3) - spin(2, k)))
    end do
    call check_value('oblique5_law_'//name, law, 0.0_wp)
    call check_value('oblique5_sliding_'//name, published, 0.0_wp)
  end subroutine oblique

  !> Velocities after an impact at 5 m/s over mu v_n; `law` takes the largest distance from the equations of the law.
  function oblique_impact(ball, psi_1, law) result(after)
    type(hertz_ball_t), intent(in) :: ball
    real(wp), intent(in) :: psi_1  !< v_t/(mu v_n)
    real(wp), intent(inout) :: law
    real(wp) :: after(3)

    real(wp), parameter :: v_n = 5.0_wp
    real(wp) :: exact(3), scale

    scale = ball%friction*v_n
    after = computed(ball, v_n, scale*psi_1, 0.0_wp)/scale
    exact = rebound(ball, v_n, scale*psi_1, 0.0_wp)/scale
    law = max(law, maxval(abs(after(2:3) - exact(2:3))))
  end function oblique_impact

  !> Test 5 again: distance from the finite elements, root mean square over the angles.
  subroutine against_finite_elements(ball)
    type(hertz_ball_t), intent(in) :: ball

    real(wp) :: after(3), law, square
    integer :: k

    law = 0
    square = 0
    do k = 1, size(finite_elements, 2)
      after = oblique_impact(ball, finite_elements(1, k), law)
      square = square + (after(2) - after(3) - finite_elements(2, k))**2/size(finite_elements, 2)
      call point('oblique5_finite_elements', finite_elements(1, k), after(2) - after(3), finite_elements(2, k))
    end do
    call check_value('oblique5_finite_elements', sqrt(square), 0.0_wp)
  end subroutine against_finite_elements

  !> Test 6: a spinning sphere meets the plane at 0.2 m/s. Against the equations at all spins, and against the published where
  !> it slides almost throughout.
  subroutine spinning(name, ball, beta)
    character(len=*), intent(in) :: name
    type(hertz_ball_t), intent(in) :: ball
    real(wp), intent(in) :: beta(:,:)  !< (2,n): 7/2 mu (1 + e) v_n/v_t, and beta

    real(wp), parameter :: v_n = 0.2_wp
    real(wp) :: v_t, after(3), exact(3), law, published
    integer :: k

    law = 0
    published = 0
    do k = 1, size(beta, 2)
      v_t = 3.5_wp*ball%friction*(1 + ball%restitution)*v_n/beta(1, k)
      after = computed(ball, v_n, 0.0_wp, -v_t)/v_t
      exact = rebound(ball, v_n, 0.0_wp, -v_t)/v_t
      law = max(law, maxval(abs(after(2:3) - exact(2:3))))
      if (beta(1, k) < 0.4_wp) published = max(published, abs(after(3) - after(2) - beta(2, k)))
      call point('spinning6_'//name, beta(1, k), after(3) - after(2), beta(2, k))
    end do
    call check_value('spinning6_law_'//name, law, 0.0_wp)
    call check_value('spinning6_sliding_'//name, published, 0.0_wp)
  end subroutine spinning

end program verify_hertz
