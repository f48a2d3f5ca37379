!> Hertz's law against closed forms: Timoshenko & Goodier, Theory of Elasticity, sec. 142, for elastic collisions, and Mindlin
!> for the tangential spring. The tests of Chung & Ooi stand in verification/verify_hertz.
! ranks: 1
program test_contact_hertz
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, run
  use impacts, only: bounced, impact_t, mass_of, material, met, rigid
  use kinds, only: wp
  use solids, only: solids_t
  implicit none

  type(communicator_t) :: comm

  call start_ranks(comm)
  call unlike_spheres()
  call frictionless_is_frictional()
  call tangential_stiffness()
  call step_limit()
  call finish()
  call stop_ranks()

contains

  !> Largest overlap of an elastic collision [m].
  pure function deepest(m, v, modulus, r)
    real(wp), intent(in) :: m, v, modulus, r  !< effective mass [kg], speed [m/s], effective modulus [Pa] and radius [m]
    real(wp) :: deepest

    deepest = (15*m*v**2/(16*modulus*sqrt(r)))**0.4_wp
  end function deepest

  !> Effective radius and mass of spheres of 1 and 3 mm; walls of another material.
  subroutine unlike_spheres()
    real(wp), parameter :: r(2) = [1.0e-3_wp, 3.0e-3_wp], modulus = 1.0e8_wp, v = 0.5_wp
    type(contact_settings_t) :: contact
    type(impact_t) :: found
    real(wp) :: m(2), e_star

    m = [mass_of(r(1), 2500.0_wp), mass_of(r(2), 2500.0_wp)]
    found = met(comm, r, 2500.0_wp, v, material(modulus, 0.25_wp, 1.0_wp, 0.0_wp))
    call expect_close(found%overlap, deepest(product(m)/sum(m), v, modulus/(2*(1 - 0.25_wp**2)), product(r)/sum(r)), 1.0e-5_wp, &
                      'unlike spheres: largest overlap')
    contact = material(modulus, 0.25_wp, 1.0_wp, 0.0_wp)
    contact%wall_youngs_modulus = 3*modulus
    contact%wall_poisson_ratio = 0.4_wp
    e_star = 1/((1 - 0.25_wp**2)/modulus + (1 - 0.4_wp**2)/(3*modulus))
    call bounced(comm, r(1), 2500.0_wp, [0.0_wp, 0.0_wp, -v], contact, found)
    call expect_close(found%overlap, deepest(m(1), v, e_star, r(1)), 1.0e-5_wp, 'another wall: largest overlap')
  end subroutine unlike_spheres

  !> Head on friction does nothing: both forms of the law agree.
  subroutine frictionless_is_frictional()
    type(impact_t) :: with, without

    with = met(comm, [1.0e-3_wp, 2.0e-3_wp], 2500.0_wp, 0.5_wp, material(1.0e8_wp, 0.3_wp, 0.7_wp, 0.3_wp))
    without = met(comm, [1.0e-3_wp, 2.0e-3_wp], 2500.0_wp, 0.5_wp, material(1.0e8_wp, 0.3_wp, 0.7_wp, 0.0_wp))
    call expect_close(without%force, with%force, 1.0e-9_wp, 'with and without friction: force')
    call expect_close(without%restitution, with%restitution, 1.0e-9_wp, 'with and without friction: restitution')
  end subroutine frictionless_is_frictional

  !> A sphere pressed on a plane and moved a little sideways without turning is pushed back by 8 G a per length.
  subroutine tangential_stiffness()
    real(wp), parameter :: r = 1.0e-3_wp, modulus = 1.0e7_wp, poisson = 0.3_wp, overlap = 1.0e-5_wp, v = 1.0e-4_wp, dt = 1.0e-9_wp
    type(contact_settings_t) :: contact
    type(solids_t) :: ball
    real(wp) :: g_star, m, k_t, expected
    integer :: steps

    contact = material(modulus, poisson, 1.0_wp, 10.0_wp)
    contact%wall_youngs_modulus = rigid
    contact%tangential_damping_ratio = 0.0_wp
    ball = scene(comm, [10*r, 10*r, 10*r], 0.0_wp, contact)
    call put(ball, reshape([5*r, 5*r, r - overlap], [3, 1]), reshape([v, 0.0_wp, 0.0_wp], [3, 1]), [2*r])
    m = mass_of(r, 2500.0_wp)
    g_star = modulus/(2*(1 + poisson)*(2 - poisson))
    k_t = 8*g_star*sqrt(r*overlap)
    steps = 200
    call run(ball, steps, dt)
    ! Constant velocity over so short a time: the spring has taken the sum of k_t v t dt of the momentum.
    expected = k_t*v*dt**2*steps*(steps + 1)/2
    call expect_close(m*(v - ball%parcels%state(5, 1)), expected, 1.0e-4_wp, 'tangential stiffness 8 G a')
    call expect_close(ball%parcels%force(ball%parcels%force_at(1)), 0.0_wp, 1.0e-300_wp, 'forces are spent')
  end subroutine tangential_stiffness

  !> The step is the shortest collision at the speed of impact over steps_per_collision, here that of two parcels or a wall.
  subroutine step_limit()
    real(wp), parameter :: r = 1.0e-3_wp, modulus = 1.0e8_wp, poisson = 0.25_wp, v = 2.0_wp
    type(contact_settings_t) :: contact
    type(solids_t) :: ball
    real(wp) :: e_star, m, pair, wall

    contact = material(modulus, poisson, 0.9_wp, 0.0_wp)
    contact%impact_velocity = v
    ball = scene(comm, [10*r, 10*r, 10*r], 0.0_wp, contact)
    call put(ball, reshape([5*r, 5*r, 5*r], [3, 1]), reshape([0.0_wp, 0.0_wp, 0.0_wp], [3, 1]), [2*r])
    e_star = modulus/(2*(1 - poisson**2))
    m = mass_of(r, 2500.0_wp)
    pair = 2.943275_wp*deepest(m/2, v, e_star, r/2)/v
    wall = 2.943275_wp*deepest(m, v, e_star, r)/v
    call expect_close(ball%time_step_limit(), min(pair, wall)/20, 1.0e-6_wp, 'the step is that of the shortest collision')
    call expect_close(ball%time_step_limit(32*v), min(pair, wall)/40, 1.0e-6_wp, 'and halves at 32 times the speed')
  end subroutine step_limit

end program test_contact_hertz
