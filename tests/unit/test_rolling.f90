!> Resistance to rolling against closed formulas: on a plane, on a slope, between two parcels.
!> ranks: 1
program test_rolling
  use chamber, only: chamber_t
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use contact_lanes, only: lanes
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, place_of, run
  use des_settings, only: des_settings_t
  use kinds, only: wp
  use outcome, only: outcome_t
  use rolling, only: rolling_t, rolling_torques
  use solids, only: solids_t
  use wall_settings, only: wall_settings_t
  use wall_scenes, only: room, cylinder, column
  implicit none

  real(wp), parameter :: g = 9.81_wp, radius = 0.5e-3_wp, stiffness = 200.0_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  call torques_of_a_pair()
  call braking('constant_torque', 1.0_wp)
  call braking('spring', 1.0_wp)
  call braking('constant_torque', 27.0_wp)
  call braking('spring', 27.0_wp)
  call coming_to_rest()
  call swing_on_a_plane()
  call swing_of_a_pair()
  call slope('spring', 0.05_wp)
  call slope('spring', 0.3_wp)
  call slope('constant_torque', 0.05_wp)
  call slope('constant_torque', 0.3_wp)
  call kept_over_lists()
  call turned_pair('constant_torque', 'linear')
  call turned_pair('spring', 'linear')
  call turned_pair('constant_torque', 'hertz')
  call turned_pair('spring', 'hertz')
  call carried_by_a_drum()
  call only_where_asked_for()
  call finish()
  call stop_ranks()

contains

  function material(rolling, mu) result(contact)
    character(len=*), intent(in) :: rolling
    real(wp), intent(in) :: mu  !< of rolling [-]
    type(contact_settings_t) :: contact

    contact%stiffness = stiffness
    contact%tangential_ratio = 1.0_wp
    contact%restitution = 0.5_wp
    contact%friction = 0.8_wp
    contact%rolling = rolling
    contact%rolling_friction = mu
    contact%rolling_damping = 0.3_wp
  end function material

  pure function mass_of(r) result(mass)
    real(wp), intent(in) :: r
    real(wp) :: mass

    mass = 2500*4*pi/3*r**3
  end function mass_of

  !> A ball of weight w at rest in its dent on the floor, where gravity pulls at an angle [rad].
  function on_floor(contact, angle, weight, speed) result(ball)
    type(contact_settings_t), intent(in) :: contact
    real(wp), intent(in) :: angle, weight, speed
    type(solids_t) :: ball

    type(chamber_t) :: chamber
    real(wp) :: big, dent

    chamber%lower = 0.0_wp
    chamber%upper = [0.03_wp, 0.01_wp, 0.01_wp]
    chamber%gravity = g*[sin(angle), 0.0_wp, -cos(angle)]
    call ball%create(comm, chamber, contact, des_settings_t(), .false., 0.0_wp)
    big = radius*weight**(1.0_wp/3.0_wp)
    dent = mass_of(big)*g*cos(angle)/contact%stiffness
    call put(ball, column([0.01_wp, 0.005_wp, big - dent]), column([speed, 0.0_wp, 0.0_wp]), [2*radius], [weight])
    ball%parcels%state(10, 1) = speed
  end function on_floor

  !> Of two balls that roll, spin and slide at once, below and beyond the limit, with both springs.
  subroutine torques_of_a_pair()
    real(wp), parameter :: r(2) = [0.4e-3_wp, 0.7e-3_wp], mu = 0.2_wp, eta = 0.35_wp, dt = 1.0e-6_wp, k_n = 800.0_wp
    real(wp), parameter :: n(3) = [0.36_wp, 0.48_wp, 0.8_wp], omega(3) = [30.0_wp, -20.0_wp, 5.0_wp], f_n = 0.002_wp
    real(wp), parameter :: modulus = 5.0e6_wp, overlap = 3.0e-6_wp
    type(rolling_t) :: law
    real(wp) :: pair(8, 1), turn(5, 1), force(3, 1), angle(3, 1), torque(3, 1), across(3), theta(3), m(2), width, k_r, c_r

    angle = 0.0_wp
    m = [mass_of(r(1)), mass_of(r(2))]
    width = product(r)/sum(r)
    pair(:, 1) = [(sum(r) - overlap)*n, sum(r), 0.0_wp, 0.0_wp, 0.0_wp, sum(1/m)]
    turn(:, 1) = [omega, 1/width, sum(1/(m*r**2))]
    force(:, 1) = f_n*n + 0.001_wp*[0.8_wp, -0.6_wp, 0.0_wp]
    across = omega - dot_product(omega, n)*n

    law = rolling_t(on=.true., mu=mu)
    call ask(law, dt, pair, turn, force, angle, torque)
    call expect_close(norm2(torque(:, 1) + mu*width*f_n*across/norm2(across)), 0.0_wp, 1.0e-20_wp, &
                      'a constant torque is mu_r R F_n against the rolling')
    turn(1:3, 1) = 1.0e-4_wp*omega
    call ask(law, dt, pair, turn, force, angle, torque)
    call expect_close(norm2(torque(:, 1) + 0.25_wp*0.4_wp/sum(1/(m*r**2))*1.0e-4_wp*across/dt), 0.0_wp, 1.0e-20_wp, &
                      'and at most a quarter of what would end it in a step')

    turn(1:3, 1) = omega
    theta = 1.0e-4_wp*[0.8_wp, -0.6_wp, 0.0_wp]
    law = rolling_t(on=.true., spring=.true., mu=mu, damping=eta, stiffness=k_n)
    k_r = 2.25_wp*k_n*(mu*width)**2
    c_r = 2*eta*sqrt(k_r/sum(1/((0.4_wp + 1)*m*r**2)))
    angle(:, 1) = theta + 1.0e-3_wp*n
    call ask(law, dt, pair, turn, force, angle, torque)
    call expect_close(norm2(torque(:, 1) + k_r*(theta + dt/2*across) + c_r*across)/norm2(torque), 0.0_wp, 1.0e-12_wp, &
                      'a rolling spring is k_r theta + C_r omega')
    call expect_close(norm2(angle(:, 1) - theta - dt*across)/norm2(theta), 0.0_wp, 1.0e-12_wp, 'its angle is what was rolled')
    angle(:, 1) = 1.0e4_wp*theta
    call ask(law, dt, pair, turn, force, angle, torque)
    call expect_close(norm2(torque), mu*width*f_n, 1.0e-12_wp, 'at most mu_r R F_n, without dashpot')
    call expect_close(dot_product(torque(:, 1), theta)/norm2(torque)/norm2(theta), -1.0_wp, 1.0e-4_wp, 'against the angle')
    call expect_close(norm2(angle(:, 1) - dt/2*across), mu*width*f_n/k_r, 1.0e-12_wp, 'which ends where the limit is')

    law%hertzian = .true.
    law%stiffness = modulus
    k_r = 2.25_wp*2*modulus*sqrt(width*overlap)*(mu*width)**2
    c_r = 2*eta*sqrt(k_r/sum(1/((0.4_wp + 1)*m*r**2)))
    angle(:, 1) = theta
    call ask(law, dt, pair, turn, force, angle, torque)
    call expect_close(norm2(torque(:, 1) + k_r*(theta + dt/2*across) + c_r*across)/norm2(torque), 0.0_wp, 1.0e-9_wp, &
                      'with Hertz k_n is 2 E a')
  end subroutine torques_of_a_pair

  !> The same pair in all lanes.
  subroutine ask(law, dt, pair, turn, force, angle, torque)
    type(rolling_t), intent(in) :: law
    real(wp), intent(in) :: dt, pair(8, 1), turn(5, 1), force(3, 1)
    real(wp), intent(inout) :: angle(3, 1)
    real(wp), intent(out) :: torque(3, 1)

    real(wp) :: angles(3, lanes), torques(3, lanes)

    angles = spread(angle(:, 1), 2, lanes)
    call rolling_torques(law, dt, lanes, spread(pair(:, 1), 2, lanes), spread(turn(:, 1), 2, lanes), &
                         spread(force(:, 1), 2, lanes), angles, torques)
    angle(:, 1) = angles(:, lanes)
    torque(:, 1) = torques(:, lanes)
  end subroutine ask

  !> A rolling ball loses 5/7 mu_r g, whatever its weight.
  subroutine braking(rolling, weight)
    character(len=*), intent(in) :: rolling
    real(wp), intent(in) :: weight

    real(wp), parameter :: mu = 0.05_wp, speed = 0.1_wp
    type(solids_t) :: ball
    real(wp) :: dt, before(2), after(2)

    ball = on_floor(material(rolling, mu), 0.0_wp, weight, speed)
    dt = ball%time_step_limit()
    call run(ball, nint(0.01_wp/dt), dt)
    before = [ball%time, ball%parcels%state(5, 1)]
    call run(ball, nint(0.02_wp/dt), dt)
    after = [ball%time, ball%parcels%state(5, 1)]
    call expect_close((before(2) - after(2))/(after(1) - before(1)), 5*mu*g/7, 1.0e-3_wp, rolling//' brakes by 5/7 mu_r g')
    call expect_close(ball%parcels%state(10, 1)/after(2), 1.0_wp, 2.0e-3_wp, 'and the ball rolls')
  end subroutine braking

  !> With the spring it stops for good, after the way of its constant braking but for what the dashpot takes while the
  !> spring is drawn to its limit, C_r omega theta.
  subroutine coming_to_rest()
    real(wp), parameter :: mu = 0.1_wp, speed = 0.02_wp
    type(solids_t) :: ball
    real(wp) :: dt, way, m, k_r, damped

    ball = on_floor(material('spring', mu), 0.0_wp, 1.0_wp, speed)
    dt = ball%time_step_limit()
    m = mass_of(radius)
    k_r = 2.25_wp*stiffness*(mu*radius)**2
    damped = 2*0.3_wp*sqrt(k_r*1.4_wp*m*radius**2)*speed/radius*mu*radius*m*g/k_r
    call run(ball, nint(0.08_wp/dt), dt)
    way = ball%parcels%state(1, 1) - 0.01_wp
    call expect_close(way, (0.7_wp*m*speed**2 - damped)/(mu*m*g), 1.0e-2_wp, 'a ball rolls 7/10 v^2/(mu_r g) far')
    call run(ball, nint(0.01_wp/dt), dt)
    call expect_close(ball%parcels%state(1, 1) - 0.01_wp - way, 0.0_wp, 1.0e-12_wp, 'and stays where it came to rest')
    call expect(all(abs(ball%parcels%state([5, 6, 10], 1)) < 1.0e-10_wp), 'without any motion')
  end subroutine coming_to_rest

  !> Below the limit a ball swings on the rolling spring and the tangential one in a row, without damping at the lower of the
  !> two frequencies of m x'' = -k_t (x - s), 2/5 m s'' = k_t (x - s) - k_r/r^2 s, where s is the angle times r.
  subroutine swing_on_a_plane()
    real(wp), parameter :: mu = 0.2_wp, k_n = stiffness, speed = 1.0e-6_wp
    type(solids_t) :: ball
    type(contact_settings_t) :: contact
    real(wp) :: dt, m, k_r, half, square, crossing(3), before, now
    integer :: n

    contact = material('spring', mu)
    contact%restitution = 1.0_wp
    contact%rolling_damping = 0.0_wp
    ball = on_floor(contact, 0.0_wp, 1.0_wp, speed)
    dt = 0.1_wp*ball%time_step_limit()
    m = mass_of(radius)
    k_r = 2.25_wp*k_n*mu**2
    half = (k_n/m + (k_n + k_r)/(0.4_wp*m))/2
    square = half - sqrt(half**2 - (k_n*(k_n + k_r) - k_n**2)/(0.4_wp*m**2))
    n = 0
    before = speed
    do
      call run(ball, 1, dt)
      now = ball%parcels%state(1, 1) - 0.01_wp
      if (ball%time > 10*dt .and. now*before < 0) then
        n = n + 1
        crossing(n) = ball%time - dt*now/(now - before)
        if (n == 3) exit
      end if
      before = now
    end do
    call expect_close(2*pi/(crossing(3) - crossing(1)), sqrt(square), 1.0e-3_wp, 'a ball swings on the rolling spring')
  end subroutine swing_on_a_plane

  !> Two balls turn against each other so that nothing slides: each has 2 I/2 theta'' = -k_r theta - C_r theta' for
  !> itself, a damped swing, while the contact lasts.
  subroutine swing_of_a_pair()
    real(wp), parameter :: mu = 5.0_wp, eta = 0.1_wp, k_n = stiffness, omega = 1.0e-3_wp
    type(solids_t) :: balls
    type(contact_settings_t) :: contact
    real(wp) :: x(3, 2), dt, m, k_r, inertia, decay, swing, expected, worst
    integer :: step

    contact = material('spring', mu)
    contact%restitution = 1.0_wp
    contact%rolling_damping = eta
    balls = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], 0.0_wp, contact)
    x = 0.005_wp
    x(1, 2) = x(1, 1) + 1.98_wp*radius
    call put(balls, x, 0*x, [2*radius, 2*radius])
    balls%parcels%state(10, place_of(balls, 1)) = omega*radius
    balls%parcels%state(10, place_of(balls, 2)) = -omega*radius
    m = mass_of(radius)
    inertia = 0.4_wp*m*radius**2/2
    k_r = 2.25_wp*k_n*(mu*radius/2)**2
    decay = eta*sqrt(k_r*0.7_wp*m*radius**2)/inertia
    swing = sqrt(k_r/inertia - decay**2)
    dt = 0.05_wp*balls%time_step_limit()
    worst = 0
    do step = 1, int(4/swing/dt)
      call run(balls, 1, dt)
      associate (t => balls%time)
        expected = exp(-decay*t)*(cos(swing*t) - decay/swing*sin(swing*t))
      end associate
      worst = max(worst, abs(balls%parcels%state(10, place_of(balls, 1))/(omega*radius) - expected))
    end do
    call expect_close(worst, 0.0_wp, 1.0e-3_wp, 'two balls that roll on each other are a damped swing')
    call expect(norm2(balls%parcels%state(1:3, 1) - balls%parcels%state(1:3, 2)) < 2*radius, 'as long as they touch')
  end subroutine swing_of_a_pair

  !> On a slope a ball goes by 5/7 g (sin a - mu_r cos a), or stays, where that is less than nothing: on the spring at rest,
  !> with the constant torque creeping at 10 g dt sin a.
  subroutine slope(rolling, angle)
    character(len=*), intent(in) :: rolling
    real(wp), intent(in) :: angle  !< [rad]

    real(wp), parameter :: mu = 0.15_wp
    type(solids_t) :: ball
    real(wp) :: dt, before(2), after(2)

    ball = on_floor(material(rolling, mu), angle, 1.0_wp, 0.0_wp)
    dt = ball%time_step_limit()
    call run(ball, nint(0.015_wp/dt), dt)
    before = [ball%time, ball%parcels%state(5, 1)]
    call run(ball, nint(0.015_wp/dt), dt)
    after = [ball%time, ball%parcels%state(5, 1)]
    if (tan(angle) > mu) then
      call expect_close((after(2) - before(2))/(after(1) - before(1)), 5*g/7*(sin(angle) - mu*cos(angle)), 1.0e-3_wp, &
                        rolling//': down a slope by 5/7 g (sin a - mu_r cos a)')
    else if (rolling == 'spring') then
      call expect_close(after(2), 0.0_wp, 1.0e-12_wp, 'on a slope below atan(mu_r) the spring holds a ball')
      call expect_close(ball%parcels%state(1, 1) - 0.01_wp, mass_of(radius)*g*sin(angle)*(1 + 1/(2.25_wp*mu**2))/stiffness, &
                        1.0e-2_wp, 'it gives way by its load over k_r, and over k_t')
    else
      call expect_close(after(2), 10*g*dt*sin(angle), 1.0e-3_wp, 'below atan(mu_r) a constant torque lets it creep')
    end if
  end subroutine slope

  !> A ball held on a slope does not notice that lists are made anew.
  subroutine kept_over_lists()
    type(solids_t) :: ball
    type(outcome_t) :: outcome
    real(wp) :: dt, x

    ball = on_floor(material('spring', 0.15_wp), 0.1_wp, 1.0_wp, 0.0_wp)
    dt = ball%time_step_limit()
    call run(ball, nint(0.04_wp/dt), dt)
    x = ball%parcels%state(1, 1)
    call ball%renew_lists(outcome)
    call run(ball, 100, dt)
    call expect_close(ball%parcels%state(1, 1) - x, 0.0_wp, 1.0e-14_wp, 'the angle is kept when lists are made anew')
  end subroutine kept_over_lists

  !> A pair that meets at an angle, spinning: momentum and angular momentum are kept, and the turned pair is turned after.
  subroutine turned_pair(rolling, law)
    character(len=*), intent(in) :: rolling, law

    real(wp), parameter :: turned(3, 3) = reshape([0.36_wp, 0.48_wp, -0.8_wp, -0.8_wp, 0.6_wp, 0.0_wp, &
                                                   0.48_wp, 0.64_wp, 0.6_wp], [3, 3])
    real(wp), parameter :: centre(3) = 0.01_wp
    type(contact_settings_t) :: contact
    real(wp) :: x(3, 2), v(3, 2), spin(3, 2), plain(9, 2), other(9, 2), sums(6, 2), idle(9, 2)
    integer :: i

    contact = material(rolling, 0.3_wp)
    contact%law = law
    contact%youngs_modulus = 2.0e7_wp
    contact%poisson_ratio = 0.25_wp
    x(:, 1) = [-0.5e-3_wp, 0.0_wp, 0.1e-3_wp]
    x(:, 2) = [0.6e-3_wp, 0.3e-3_wp, -0.1e-3_wp]
    v(:, 1) = [0.3_wp, 0.1_wp, 0.0_wp]
    v(:, 2) = [-0.2_wp, 0.0_wp, 0.05_wp]
    spin(:, 1) = [0.1_wp, 0.2_wp, -0.3_wp]
    spin(:, 2) = [-0.3_wp, 0.1_wp, 0.2_wp]
    plain(1:3, :) = x
    plain(4:6, :) = v
    plain(7:9, :) = spin
    sums(:, 1) = momenta(plain)
    other(1:3, :) = matmul(turned, x)
    other(4:6, :) = matmul(turned, v)
    other(7:9, :) = matmul(turned, spin)
    call collide(contact, centre, plain)
    call collide(contact, centre, other)
    sums(:, 2) = momenta(plain)
    call expect_close(norm2(sums(1:3, 2) - sums(1:3, 1)), 0.0_wp, 1.0e-14_wp*0.3_wp, rolling//', '//law//': momentum is kept')
    call expect_close(norm2(sums(4:6, 2) - sums(4:6, 1)), 0.0_wp, 1.0e-11_wp*0.3e-3_wp, 'and angular momentum')
    do i = 1, 9, 3
      plain(i:i + 2, :) = matmul(turned, plain(i:i + 2, :))
    end do
    call expect(maxval(abs(other - plain)) < 1.0e-12_wp, 'a turned pair is turned after')
    call expect(norm2(plain(4:6, 1) - matmul(turned, v(:, 1))) > 0.1_wp, 'and they did meet')
    contact%rolling = 'none'
    idle(1:3, :) = x
    idle(4:6, :) = v
    idle(7:9, :) = spin
    call collide(contact, centre, idle)
    call expect(norm2(matmul(turned, idle(7:9, :)) - plain(7:9, :)) > 1.0e-3_wp, 'and resisted rolling')
  end subroutine turned_pair

  !> Where two balls of 1.0 and 1.3 mm are after 3 ms: position, velocity, spin times radius.
  subroutine collide(contact, centre, balls)
    type(contact_settings_t), intent(in) :: contact
    real(wp), intent(in) :: centre(3)
    real(wp), intent(inout) :: balls(9, 2)

    type(solids_t) :: pair
    integer :: i

    pair = scene(comm, [0.02_wp, 0.02_wp, 0.02_wp], 0.0_wp, contact)
    call put(pair, balls(1:3, :) + spread(centre, 2, 2), balls(4:6, :), [1.0e-3_wp, 1.3e-3_wp])
    do i = 1, 2
      pair%parcels%state(9:11, place_of(pair, i)) = balls(7:9, i)
    end do
    call run(pair, 600, 5.0e-6_wp)
    do i = 1, 2
      associate (s => pair%parcels%state(:, place_of(pair, i)))
        balls(:, i) = [s(1:3) - centre, s(5:7), s(9:11)]
      end associate
    end do
  end subroutine collide

  !> Momentum and angular momentum of the two, over the mass of a ball of 1 mm.
  pure function momenta(balls) result(sums)
    real(wp), intent(in) :: balls(9, 2)
    real(wp) :: sums(6)

    real(wp), parameter :: width(2) = [1.0_wp, 1.3_wp]
    integer :: i

    sums = 0.0_wp
    do i = 1, 2
      associate (x => balls(1:3, i), v => balls(4:6, i), m => width(i)**3)
        sums(1:3) = sums(1:3) + m*v
        sums(4) = sums(4) + m*(x(2)*v(3) - x(3)*v(2))
        sums(5) = sums(5) + m*(x(3)*v(1) - x(1)*v(3))
        sums(6) = sums(6) + m*(x(1)*v(2) - x(2)*v(1))
        sums(4:6) = sums(4:6) + m*0.4_wp*width(i)*radius*balls(7:9, i)
      end associate
    end do
  end function momenta

  !> In a turning drum without gravity a ball that turns with it, pressed on by its own weight, goes on so.
  subroutine carried_by_a_drum()
    real(wp), parameter :: omega = 60.0_wp, inner = 8.0e-3_wp, k = stiffness, axis(3) = [0.0_wp, 1.0_wp, 0.0_wp]
    type(solids_t) :: ball
    type(contact_settings_t) :: contact
    real(wp) :: way, m
    type(wall_settings_t) :: drum
    integer :: kind

    drum = cylinder([0.01_wp, 0.01_wp, 0.01_wp], axis, inner)
    drum%angular_velocity = omega*axis
    m = mass_of(radius)
    way = inner - radius
    way = way*k/(k - m*omega**2)
    do kind = 1, 2
      contact = material(merge('spring         ', 'constant_torque', kind == 1), 0.2_wp)
      ball = room(comm, 0.02_wp, [0.0_wp, 0.0_wp, 0.0_wp], contact, [drum])
      call put(ball, column([0.01_wp + way, 0.01_wp, 0.01_wp]), column([0.0_wp, 0.0_wp, -omega*way]), [2*radius])
      ball%parcels%state(9:11, 1) = omega*radius*axis
      call run(ball, nint(pi/omega/ball%time_step_limit()), ball%time_step_limit())
      call expect_close(ball%parcels%state(10, 1), omega*radius, 1.0e-3_wp, 'a ball that turns with a drum does not roll: ' &
                        //trim(contact%rolling))
    end do
  end subroutine carried_by_a_drum

  !> Without the spring no angle is kept, and a constant torque has no memory at all.
  subroutine only_where_asked_for()
    type(solids_t) :: ball

    ball = on_floor(material('none', 0.2_wp), 0.0_wp, 1.0_wp, 0.0_wp)
    call run(ball, 1, ball%time_step_limit())
    call expect(.not. (allocated(ball%pairs%angle) .or. allocated(ball%walls%angle) .or. any(ball%laws%pair%rolling%on)), &
                'without resistance there is nothing of it')
    ball = on_floor(material('constant_torque', 0.2_wp), 0.0_wp, 1.0_wp, 0.0_wp)
    call run(ball, 1, ball%time_step_limit())
    call expect(.not. (allocated(ball%pairs%angle) .or. allocated(ball%walls%angle)) .and. ball%history%rows == 3, &
                'a constant torque keeps no angle')
    ball = on_floor(material('spring', 0.2_wp), 0.0_wp, 1.0_wp, 0.0_wp)
    call run(ball, 1, ball%time_step_limit())
    call expect(allocated(ball%pairs%angle) .and. allocated(ball%walls%angle) .and. ball%history%rows == 6, 'the spring does')
  end subroutine only_where_asked_for

end program test_rolling
