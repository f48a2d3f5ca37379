!> Hertz's law against closed forms: Timoshenko & Goodier, Theory of Elasticity, sec. 142, for elastic collisions, Mindlin
!> for the tangential spring, and tests 1, 2, 5 of Chung & Ooi, Granul. Matter 13 (2011) 643-656.
! ranks: 1
program test_contact_hertz
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, run
  use kinds, only: wp
  use solids, only: solids_t
  implicit none

  real(wp), parameter :: rigid = 1.0e30_wp  !< modulus of a wall that does not yield [Pa]

  !> What a parcel that meets a wall or its like head on went through.
  type :: impact_t
    real(wp) :: overlap = 0.0_wp   !< largest [m]
    real(wp) :: force = 0.0_wp     !< largest [N]
    real(wp) :: duration = 0.0_wp  !< [s]
    real(wp) :: restitution = 0.0_wp
  end type impact_t

  type(communicator_t) :: comm

  call start_ranks(comm)
  call equal_spheres()
  call rigid_plane()
  call unlike_spheres()
  call restitutions()
  call frictionless_is_frictional()
  call sliding()
  call tangential_stiffness()
  call step_limit()
  call finish()
  call stop_ranks()

contains

  pure function material(modulus, poisson, restitution, friction) result(contact)
    real(wp), intent(in) :: modulus, poisson, restitution, friction  !< [Pa], [-], [-], [-]
    type(contact_settings_t) :: contact

    contact%law = 'hertz'
    contact%youngs_modulus = modulus
    contact%poisson_ratio = poisson
    contact%restitution = restitution
    contact%friction = friction
  end function material

  pure function mass_of(radius, density)
    real(wp), intent(in) :: radius, density
    real(wp) :: mass_of

    mass_of = density*4*pi/3*radius**3
  end function mass_of

  !> Largest overlap of an elastic collision [m].
  pure function deepest(m, v, modulus, r)
    real(wp), intent(in) :: m, v, modulus, r  !< effective mass [kg], speed [m/s], effective modulus [Pa] and radius [m]
    real(wp) :: deepest

    deepest = (15*m*v**2/(16*modulus*sqrt(r)))**0.4_wp
  end function deepest

  !> Test 1 of Chung & Ooi: two glass spheres of 10 mm radius meet at 10 m/s each.
  subroutine equal_spheres()
    real(wp), parameter :: r = 0.01_wp, modulus = 4.8e10_wp, poisson = 0.2_wp, v = 20.0_wp
    type(impact_t) :: found
    real(wp) :: e_star, overlap

    e_star = modulus/(2*(1 - poisson**2))
    overlap = deepest(mass_of(r, 2800.0_wp)/2, v, e_star, r/2)
    found = met([r, r], 2800.0_wp, v, material(modulus, poisson, 1.0_wp, 0.35_wp))
    call expect_close(found%overlap, overlap, 1.0e-5_wp, 'two spheres: largest overlap')
    call expect_close(found%force, 4.0_wp/3.0_wp*e_star*sqrt(r/2)*overlap**1.5_wp, 1.0e-5_wp, 'two spheres: largest force')
    call expect_close(found%duration, 2.943275_wp*overlap/v, 1.0e-4_wp, 'two spheres: duration 2.9433 delta/v')
    call expect_close(found%restitution, 1.0_wp, 1.0e-5_wp, 'two spheres: elastic')
  end subroutine equal_spheres

  !> Test 2: a sphere of aluminium alloy, 0.1 m radius, on a rigid plane at 0.2 m/s.
  subroutine rigid_plane()
    real(wp), parameter :: r = 0.1_wp, modulus = 7.0e10_wp, poisson = 0.3_wp, v = 0.2_wp
    type(contact_settings_t) :: contact
    type(impact_t) :: found
    real(wp) :: e_star, overlap

    contact = material(modulus, poisson, 1.0_wp, 0.0_wp)
    contact%wall_youngs_modulus = rigid
    e_star = modulus/(1 - poisson**2)
    overlap = deepest(mass_of(r, 2699.0_wp), v, e_star, r)
    found = bounced(r, 2699.0_wp, [0.0_wp, 0.0_wp, -v], contact)
    call expect_close(found%overlap, overlap, 1.0e-5_wp, 'rigid plane: largest overlap')
    call expect_close(found%force, 4.0_wp/3.0_wp*e_star*sqrt(r)*overlap**1.5_wp, 1.0e-5_wp, 'rigid plane: largest force')
    call expect_close(found%duration, 2.943275_wp*overlap/v, 1.0e-4_wp, 'rigid plane: duration')
  end subroutine rigid_plane

  !> Effective radius and mass of spheres of 1 and 3 mm; walls of another material.
  subroutine unlike_spheres()
    real(wp), parameter :: r(2) = [1.0e-3_wp, 3.0e-3_wp], modulus = 1.0e8_wp, v = 0.5_wp
    type(contact_settings_t) :: contact
    type(impact_t) :: found
    real(wp) :: m(2), e_star

    m = [mass_of(r(1), 2500.0_wp), mass_of(r(2), 2500.0_wp)]
    found = met(r, 2500.0_wp, v, material(modulus, 0.25_wp, 1.0_wp, 0.0_wp))
    call expect_close(found%overlap, deepest(product(m)/sum(m), v, modulus/(2*(1 - 0.25_wp**2)), product(r)/sum(r)), 1.0e-5_wp, &
                      'unlike spheres: largest overlap')
    contact = material(modulus, 0.25_wp, 1.0_wp, 0.0_wp)
    contact%wall_youngs_modulus = 3*modulus
    contact%wall_poisson_ratio = 0.4_wp
    e_star = 1/((1 - 0.25_wp**2)/modulus + (1 - 0.4_wp**2)/(3*modulus))
    found = bounced(r(1), 2500.0_wp, [0.0_wp, 0.0_wp, -v], contact)
    call expect_close(found%overlap, deepest(m(1), v, e_star, r(1)), 1.0e-5_wp, 'another wall: largest overlap')
  end subroutine unlike_spheres

  !> The restitution asked for, at any speed (test 3), for walls and for pairs, with and without friction.
  subroutine restitutions()
    real(wp), parameter :: asked(5) = [0.2_wp, 0.4_wp, 0.6_wp, 0.8_wp, 0.95_wp], speed(3) = [0.02_wp, 0.4_wp, 3.9_wp]
    type(impact_t) :: found
    character(len=40) :: name
    integer :: i, j

    do i = 1, size(asked)
      do j = 1, size(speed)
        write (name, '(a,f5.2,a,f5.2,a)') 'restitution', asked(i), ' at', speed(j), ' m/s'
        found = bounced(2.5e-3_wp, 4000.0_wp, [0.0_wp, 0.0_wp, -speed(j)], material(3.8e9_wp, 0.23_wp, asked(i), 0.0_wp))
        call expect_close(found%restitution, asked(i), 2.0e-4_wp, trim(name)//', wall')
      end do
      found = met([1.0e-3_wp, 2.0e-3_wp], 2500.0_wp, 0.5_wp, material(1.0e8_wp, 0.3_wp, asked(i), 0.3_wp))
      call expect_close(found%restitution, asked(i), 2.0e-4_wp, trim(name)//', pair')
    end do
  end subroutine restitutions

  !> Head on friction does nothing: both forms of the law agree.
  subroutine frictionless_is_frictional()
    type(impact_t) :: with, without

    with = met([1.0e-3_wp, 2.0e-3_wp], 2500.0_wp, 0.5_wp, material(1.0e8_wp, 0.3_wp, 0.7_wp, 0.3_wp))
    without = met([1.0e-3_wp, 2.0e-3_wp], 2500.0_wp, 0.5_wp, material(1.0e8_wp, 0.3_wp, 0.7_wp, 0.0_wp))
    call expect_close(without%force, with%force, 1.0e-9_wp, 'with and without friction: force')
    call expect_close(without%restitution, with%restitution, 1.0e-9_wp, 'with and without friction: restitution')
  end subroutine frictionless_is_frictional

  !> Test 5, where it slides throughout: friction takes mu (1 + e) v_n of the tangential velocity and gives (5/2) of that as
  !> spin times radius. A hundredth of the speed there, so that the overlap, which shortens the arm, is small.
  subroutine sliding()
    real(wp), parameter :: r = 1.0e-5_wp, mu = 0.3_wp, v_n = 0.05_wp, v_t = 0.15_wp
    type(contact_settings_t) :: contact
    type(solids_t) :: ball
    type(impact_t) :: found

    contact = material(2.08e11_wp, 0.3_wp, 1.0_wp, mu)
    contact%wall_youngs_modulus = rigid
    contact%impact_velocity = v_n
    found = bounced(r, 7850.0_wp, [v_t, 0.0_wp, -v_n], contact, ball)
    call expect_close(found%restitution, 1.0_wp, 1.0e-3_wp, 'sliding: normal velocity')
    call expect_close(ball%parcels%state(5, 1), v_t - 2*mu*v_n, 1.0e-3_wp, 'sliding: tangential velocity')
    call expect_close(ball%parcels%state(10, 1), 2.5_wp*2*mu*v_n, 1.0e-3_wp, 'sliding: spin')
  end subroutine sliding

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
    call expect_close(ball%parcels%force(1, 1), 0.0_wp, 1.0e-300_wp, 'forces are spent')
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

  !> A parcel meets the floor.
  function bounced(r, density, velocity, contact, last) result(impact)
    real(wp), intent(in) :: r, density, velocity(3)
    type(contact_settings_t), intent(in) :: contact
    type(solids_t), intent(out), optional :: last
    type(impact_t) :: impact

    type(solids_t) :: ball
    real(wp), parameter :: gap = 1.0e-6_wp  !< of a radius

    ball = scene(comm, [100*r, 100*r, 10*r], 0.0_wp, contact)
    call put(ball, reshape([50*r, 50*r, (1 + gap)*r], [3, 1]), reshape(velocity, [3, 1]), [2*r], density=[density])
    call follow(ball, 1, abs(velocity(3)), mass_of(r, density), impact)
    if (present(last)) last = ball
  end function bounced

  !> Two parcels meet at v.
  function met(r, density, v, contact) result(impact)
    real(wp), intent(in) :: r(2), density, v
    type(contact_settings_t), intent(in) :: contact
    type(impact_t) :: impact

    type(solids_t) :: pair
    real(wp) :: side, m(2)

    side = 20*maxval(r)
    m = [mass_of(r(1), density), mass_of(r(2), density)]
    pair = scene(comm, [side, side, side], 0.0_wp, contact)
    call put(pair, reshape([side/2, side/2, side/2, side/2, side/2, side/2 + (1 + 1.0e-6_wp)*sum(r)], [3, 2]), &
             reshape([0.0_wp, 0.0_wp, v/2, 0.0_wp, 0.0_wp, -v/2], [3, 2]), 2*r, density=[density, density])
    call follow(pair, 2, v, product(m)/sum(m), impact)
  end function met

  !> Take fine steps until the contact is over; parabolas through the records find its ends and extremes well enough.
  subroutine follow(solids, n, v, m, impact)
    type(solids_t), intent(inout) :: solids
    integer, intent(in) :: n       !< parcels
    real(wp), intent(in) :: v, m   !< speed of the approach [m/s], effective mass [kg]
    type(impact_t), intent(out) :: impact

    real(wp) :: dt, gap, before, speed, last, began, ended
    integer :: step

    dt = solids%time_step_limit(v)/100
    began = -1.0_wp
    ended = -1.0_wp
    call gap_and_speed(solids, n, before, last)
    do step = 1, 200000
      call run(solids, 1, dt)
      call gap_and_speed(solids, n, gap, speed)
      impact%overlap = max(impact%overlap, -gap)
      impact%force = max(impact%force, m*(speed - last)/dt)
      if (gap < 0.0_wp .and. began < 0.0_wp) began = solids%time - dt*gap/(gap - before)
      if (gap >= 0.0_wp .and. before < 0.0_wp) ended = solids%time - dt*gap/(gap - before)
      before = gap
      last = speed
      if (ended > 0.0_wp) exit
    end do
    impact%duration = ended - began
    impact%restitution = speed/v
  end subroutine follow

  !> Gap of the two parcels, or of one and the floor, and how fast it grows.
  pure subroutine gap_and_speed(solids, n, gap, speed)
    type(solids_t), intent(in) :: solids
    integer, intent(in) :: n
    real(wp), intent(out) :: gap, speed  !< [m], [m/s]

    associate (s => solids%parcels%state)
      if (n == 1) then
        gap = s(3, 1) - s(4, 1)
        speed = s(7, 1)
      else
        gap = abs(s(3, 2) - s(3, 1)) - s(4, 1) - s(4, 2)
        speed = (s(7, 2) - s(7, 1))*sign(1.0_wp, s(3, 2) - s(3, 1))
      end if
    end associate
  end subroutine gap_and_speed

end program test_contact_hertz
