!> Attraction against closed formulas: forces by distance, what parts a pair, what makes it stick.
!> ranks: 1
program test_cohesion
  use chamber, only: chamber_t
  use check, only: expect, expect_close, finish
  use cohesion, only: cohesion_t, attractions
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, place_of, run
  use des_settings, only: des_settings_t
  use kinds, only: wp
  use solids, only: solids_t
  implicit none

  ! Balls of 0.1 mm and 1.3e-9 kg: touching ones attract each other with three times their weight.
  real(wp), parameter :: r = 50.0e-6_wp, m = 2500*4*pi/3*r**3, k = 1.0_wp
  real(wp), parameter :: a = 1.0e-18_wp, near = 1.0e-8_wp, far = 1.0e-6_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  call forces_by_distance()
  call hangs_from_ceiling()
  call hangs_by_area()
  call escapes(of_wall=.false.)
  call escapes(of_wall=.true.)
  call escapes_by_area()
  call agglomerates()
  call friction_of_attraction()
  call steps()
  call weight_of_27()
  call finish()
  call stop_ranks()

contains

  function sticky(restitution) result(contact)
    real(wp), intent(in) :: restitution
    type(contact_settings_t) :: contact

    contact%stiffness = k
    contact%restitution = restitution
    contact%cohesion = 'van_der_waals'
    contact%hamaker_constant = a
    contact%minimum_separation = near
    contact%maximum_separation = far
  end function sticky

  !> Hertz with attraction by area.
  function sticky_by_area(restitution) result(contact)
    real(wp), intent(in) :: restitution
    type(contact_settings_t) :: contact

    contact%law = 'hertz'
    contact%youngs_modulus = 1.0e6_wp
    contact%poisson_ratio = 0.25_wp
    contact%impact_velocity = 0.01_wp
    contact%restitution = restitution
    contact%cohesion = 'linear'
    contact%cohesion_energy = 0.03_wp*modulus(contact)
  end function sticky_by_area

  pure function modulus(contact)
    type(contact_settings_t), intent(in) :: contact
    real(wp) :: modulus

    modulus = contact%youngs_modulus/(2*(1 - contact%poisson_ratio**2))
  end function modulus

  !> A box with a ball in it, x from the middle of the box, gravity along z.
  function with_ball(contact, gravity, x, v) result(solids)
    type(contact_settings_t), intent(in) :: contact
    real(wp), intent(in) :: gravity, x(3), v(3)
    type(solids_t) :: solids

    type(chamber_t) :: chamber
    real(wp) :: place(3, 1), velocity(3, 1)

    chamber%lower = 0.0_wp
    chamber%upper = 1.0e-3_wp
    chamber%gravity = [0.0_wp, 0.0_wp, gravity]
    call solids%create(comm, chamber, contact, des_settings_t(), .false., 0.0_wp)
    place(:, 1) = 0.5e-3_wp + x
    velocity(:, 1) = v
    call put(solids, place, velocity, [2*r])
  end function with_ball

  subroutine forces_by_distance()
    real(wp), parameter :: n(3) = [0.36_wp, 0.48_wp, 0.8_wp], radii(2) = [40.0e-6_wp, 70.0e-6_wp]
    real(wp), parameter :: gap(6) = [-1.0e-7_wp, 0.5e-8_wp, 2.0e-8_wp, 1.0e-7_wp, 0.99e-6_wp, 1.01e-6_wp]
    type(cohesion_t) :: law
    real(wp) :: pair(4, 6), force(3, 6), curvature(6), width, pull(6)
    integer :: i

    width = product(radii)/sum(radii)
    curvature = 1/width
    do i = 1, 6
      pair(:, i) = [(sum(radii) + gap(i))*n, sum(radii)]
    end do
    law = cohesion_t(.true., .true., a/6, near, far)
    call attractions(law, 6, pair, curvature, force)
    pull = a*width/6*[1/near**2, 1/near**2, 1/gap(3)**2, 1/gap(4)**2, 1/gap(5)**2, 0.0_wp]
    do i = 1, 6
      call expect_close(norm2(force(:, i) + pull(i)*n), 0.0_wp, 1.0e-6_wp*max(pull(i), tiny(pull)), &
                        'van der Waals: A R/(6 h^2) between its limits')
    end do
    law = cohesion_t(.true., .false., pi*5.0e3_wp, 0.0_wp, 0.0_wp)
    call attractions(law, 6, pair, curvature, force)
    call expect_close(norm2(force(:, 1) + 5.0e3_wp*pi*width*1.0e-7_wp*n)/norm2(force(:, 1)), 0.0_wp, 1.0e-9_wp, &
                      'linear: k pi R delta')
    call expect_close(norm2(force(:, 2:)), 0.0_wp, 0.0_wp, 'and nothing apart')
  end subroutine forces_by_distance

  !> A ball hangs from the ceiling if it weighs less than A r/(6 h_min^2).
  subroutine hangs_from_ceiling()
    real(wp), parameter :: most = a*r/(6*near**2)
    type(solids_t) :: ball
    real(wp) :: share, dent
    integer :: i

    do i = 1, 2
      share = merge(0.99_wp, 1.01_wp, i == 1)
      dent = max((1 - share)*most/k, 0.0_wp)
      ball = with_ball(sticky(0.5_wp), -share*most/m, [0.0_wp, 0.0_wp, 0.5e-3_wp - r + dent], [0.0_wp, 0.0_wp, 0.0_wp])
      call run(ball, nint(5.0e-3_wp/ball%time_step_limit()), ball%time_step_limit())
      if (i == 1) call expect_close(ball%parcels%state(3, 1), 1.0e-3_wp - r + dent, 1.0e-9_wp, 'a light ball hangs')
      if (i == 2) call expect(ball%parcels%state(3, 1) < 1.0e-3_wp - r - far, 'a heavy ball falls')
    end do
  end subroutine hangs_from_ceiling

  !> With Hertz and attraction by area the largest pull is (pi^3/12) k^3 r^2/E^2, at 4/9 of the overlap at rest,
  !> r (3 pi k/(4 E))^2.
  subroutine hangs_by_area()
    type(contact_settings_t) :: contact
    type(solids_t) :: ball
    real(wp) :: e, most, rest, share
    integer :: i

    contact = sticky_by_area(0.3_wp)
    e = modulus(contact)
    most = pi**3/12*contact%cohesion_energy**3*r**2/e**2
    rest = r*(3*pi*contact%cohesion_energy/(4*e))**2
    do i = 1, 2
      share = merge(0.99_wp, 1.01_wp, i == 1)
      ball = with_ball(contact, -share*most/m, [0.0_wp, 0.0_wp, 0.5e-3_wp - r + 4*rest/9], [0.0_wp, 0.0_wp, 0.0_wp])
      call run(ball, nint(5.0e-3_wp/ball%time_step_limit()), ball%time_step_limit())
      call expect(ball%parcels%state(3, 1) > 1.0e-3_wp - r .eqv. i == 1, 'by area a ball hangs, too, if it is light')
    end do
    ball = with_ball(contact, 0.0_wp, [0.0_wp, 0.0_wp, 0.5e-3_wp - r + 4*rest/9], [0.0_wp, 0.0_wp, 0.0_wp])
    call run(ball, nint(5.0e-3_wp/ball%time_step_limit()), ball%time_step_limit())
    call expect_close(ball%parcels%state(3, 1) - 1.0e-3_wp + r, rest, 1.0e-6_wp, 'at rest it overlaps by r (3 pi k/(4 E))^2')
  end subroutine hangs_by_area

  !> Energy it takes to part surfaces at rest on a spring without damping, R width of the pair:
  !> F^2/(2 k) + F h_min + A R/6 (1/h_min - 1/h_max), F = A R/(6 h_min^2).
  pure function well(width) result(energy)
    real(wp), intent(in) :: width
    real(wp) :: energy(2)  !< in contact, and outside [J]

    real(wp) :: f

    f = a*width/(6*near**2)
    energy = [f**2/(2*k), f*near + a*width/6*(1/near - 1/far)]
  end function well

  subroutine escapes(of_wall)
    logical, intent(in) :: of_wall

    type(solids_t) :: balls
    real(wp) :: width, mass, critical, speed, x(3, 2), v(3, 2), apart, dt
    integer :: i, step

    width = merge(r, r/2, of_wall)
    mass = merge(m, m/2, of_wall)
    critical = sqrt(2*sum(well(width))/mass)
    do i = 1, 2
      speed = merge(0.99_wp, 1.01_wp, i == 1)*critical
      if (of_wall) then
        balls = with_ball(sticky(1.0_wp), 0.0_wp, [0.0_wp, 0.0_wp, r - 0.5e-3_wp - a*width/(6*near**2)/k], &
                          [0.0_wp, 0.0_wp, speed])
      else
        balls = scene(comm, [1.0e-3_wp, 1.0e-3_wp, 1.0e-3_wp], 0.0_wp, sticky(1.0_wp))
        x = 0.5e-3_wp
        x(1, 2) = x(1, 1) + 2*r - a*width/(6*near**2)/k
        v = 0
        v(1, :) = [-0.5_wp, 0.5_wp]*speed
        call put(balls, x, v, [2*r, 2*r])
      end if
      dt = 0.2_wp*balls%time_step_limit()
      do step = 1, nint(20*far/critical/dt)
        call run(balls, 1, dt)
        if (gap(balls) > far) exit
      end do
      associate (s => balls%parcels%state)
        apart = merge(s(7, 1), abs(s(5, 1) - s(5, balls%parcels%n)), of_wall)
      end associate
      call expect(gap(balls) > far .eqv. i == 2, merge('a ball parts from a wall above its escape velocity', &
                                                       'two balls part above their escape velocity        ', of_wall))
      if (i == 2) call expect_close(apart, sqrt(speed**2 - critical**2), 3.0e-3_wp, 'with what is left of it')
    end do
  end subroutine escapes

  !> The same by area: 1/10 (pi k R)^5/(4/3 E sqrt(R))^4.
  subroutine escapes_by_area()
    type(contact_settings_t) :: contact
    type(solids_t) :: balls
    real(wp) :: e, rest, critical, speed, x(3, 2), v(3, 2), dt
    integer :: i

    contact = sticky_by_area(1.0_wp)
    e = modulus(contact)
    rest = r/2*(3*pi*contact%cohesion_energy/(4*e))**2
    critical = sqrt(2*0.1_wp*(pi*contact%cohesion_energy*r/2)**5/(4*e*sqrt(r/2)/3)**4/(m/2))
    do i = 1, 2
      speed = merge(0.98_wp, 1.02_wp, i == 1)*critical
      balls = scene(comm, [1.0e-3_wp, 1.0e-3_wp, 1.0e-3_wp], 0.0_wp, contact)
      x = 0.5e-3_wp
      x(1, 2) = x(1, 1) + 2*r - rest
      v = 0
      v(1, :) = [-0.5_wp, 0.5_wp]*speed
      call put(balls, x, v, [2*r, 2*r])
      dt = 0.2_wp*balls%time_step_limit()
      call run(balls, nint(20*rest/critical/dt), dt)
      call expect(gap(balls) > 0.0_wp .eqv. i == 2, 'by area two balls part above their escape velocity')
    end do
  end subroutine escapes_by_area

  pure function gap(solids)
    type(solids_t), intent(in) :: solids
    real(wp) :: gap

    associate (s => solids%parcels%state)
      if (solids%parcels%n == 1) gap = s(3, 1) - s(4, 1)
      if (solids%parcels%n == 2) gap = norm2(s(1:3, 1) - s(1:3, 2)) - s(4, 1) - s(4, 2)
    end associate
  end function gap

  !> Balls that meet below a certain speed stay together. It is the one with which they leave the contact with just the energy
  !> of the attraction outside, after a damped swing under its constant force.
  subroutine agglomerates()
    real(wp), parameter :: e = 0.6_wp
    type(solids_t) :: balls
    real(wp) :: outside(2), critical, low, high, speed, x(3, 2), v(3, 2), dt, nearest
    integer :: i, step

    outside = well(r/2)
    low = 0
    high = 1.0_wp
    do i = 1, 60
      critical = (low + high)/2
      if (left_with(sqrt(critical**2 + 2*outside(2)/(m/2)), e)**2 < 2*outside(2)/(m/2)) then
        low = critical
      else
        high = critical
      end if
    end do
    call expect(critical > 1.0e-3_wp .and. critical < 0.1_wp, 'there is such a speed')
    do i = 1, 2
      speed = merge(0.97_wp, 1.03_wp, i == 1)*critical
      balls = scene(comm, [1.0e-3_wp, 1.0e-3_wp, 1.0e-3_wp], 0.0_wp, sticky(e))
      x = 0.5e-3_wp
      x(1, 2) = x(1, 1) + 2*r + 1.1_wp*far
      v = 0
      v(1, :) = [0.5_wp, -0.5_wp]*speed
      call put(balls, x, v, [2*r, 2*r])
      dt = 0.1_wp*balls%time_step_limit()
      nearest = far
      do step = 1, nint(40*far/critical/dt)
        call run(balls, 1, dt)
        nearest = min(nearest, gap(balls))
        if (nearest < 0 .and. gap(balls) > far) exit
      end do
      call expect(gap(balls) > far .eqv. i == 2, 'balls stick below the speed of agglomeration, and not above')
      call expect(nearest < 0, 'and they did meet')
    end do
  end subroutine agglomerates

  !> Speed with which the overlap of two balls that began with `speed` ends; 0 if it never does.
  pure function left_with(speed, restitution) result(after)
    real(wp), intent(in) :: speed, restitution
    real(wp) :: after

    real(wp) :: zeta, omega, damped, rest, b, t, step, delta
    integer :: i

    zeta = -log(restitution)/sqrt(pi**2 + log(restitution)**2)
    omega = sqrt(k/(m/2))
    damped = omega*sqrt(1 - zeta**2)
    rest = a*(r/2)/(6*near**2)/k
    b = (speed - zeta*omega*rest)/damped
    step = 1.0e-4_wp/omega
    after = 0
    do i = 1, 100000
      t = i*step
      delta = rest + exp(-zeta*omega*t)*(b*sin(damped*t) - rest*cos(damped*t))
      if (delta > 0) cycle
      after = -exp(-zeta*omega*t)*(damped*(b*cos(damped*t) + rest*sin(damped*t)) &
                                   - zeta*omega*(b*sin(damped*t) - rest*cos(damped*t)))
      return
    end do
  end function left_with

  !> Friction sees the repulsion that balances the attraction: a ball without weight slides on a floor by mu F/m.
  subroutine friction_of_attraction()
    real(wp), parameter :: mu = 0.3_wp, u = 0.01_wp, f = a*r/(6*near**2)
    type(contact_settings_t) :: contact
    type(solids_t) :: ball

    contact = sticky(0.5_wp)
    contact%friction = mu
    ball = with_ball(contact, 0.0_wp, [-2.0e-4_wp, 0.0_wp, r - f/k - 0.5e-3_wp], [u, 0.0_wp, 0.0_wp])
    call run(ball, nint(0.1_wp*u*m/(mu*f)/ball%time_step_limit()), ball%time_step_limit())
    call expect_close((u - ball%parcels%state(5, 1))/ball%time, mu*f/m, 1.0e-6_wp, 'friction of a ball that is attracted')
  end subroutine friction_of_attraction

  !> A twentieth of half a swing at h_min, for the pair or ball at a wall with the largest r/m.
  subroutine steps()
    type(contact_settings_t) :: contact
    type(solids_t) :: balls
    real(wp) :: x(3, 2)

    contact = sticky(0.9_wp)
    contact%minimum_separation = 1.0e-9_wp
    balls = scene(comm, [1.0e-3_wp, 1.0e-3_wp, 1.0e-3_wp], 0.0_wp, contact)
    x = 0.3e-3_wp
    x(1, 2) = 0.6e-3_wp
    call put(balls, x, 0*x, [2*r, 3*r])
    call expect_close(balls%time_step_limit(), pi/sqrt(a*r/(3*1.0e-27_wp)/m)/20, 1.0e-12_wp, 'a steep attraction sets the step')
    call expect_close(balls%range, 3*r + balls%skin + far, 1.0e-12_wp, 'pairs are listed as far as it reaches')
  end subroutine steps

  !> Parcels of 27 with 9 times the constant attract each other with 27 times the force of two particles, at equal gaps.
  subroutine weight_of_27()
    type(cohesion_t) :: law
    real(wp) :: one(3, 1), parcels(3, 1), pair(4, 1)
    integer :: i

    do i = 1, 2
      pair(:, 1) = [2*r + i*near, 0.0_wp, 0.0_wp, 2*r]
      law = cohesion_t(.true., .true., a/6, near, far)
      call attractions(law, 1, pair, [2/r], one)
      pair(:, 1) = [6*r + i*near, 0.0_wp, 0.0_wp, 6*r]
      law%strength = 9*a/6
      call attractions(law, 1, pair, [2/(3*r)], parcels)
      call expect_close(parcels(1, 1), 27*one(1, 1), 1.0e-6_wp, 'parcels of 27 attract each other as 27 pairs')
    end do
  end subroutine weight_of_27

end program test_cohesion
