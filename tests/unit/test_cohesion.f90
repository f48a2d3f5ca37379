!> Attraction against closed formulas: forces by distance, what parts a pair, what makes it stick.
!> ranks: 1
program test_cohesion
  use check, only: expect, expect_close, finish
  use cohesion, only: cohesion_t, attractions
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use contact_lanes, only: lanes
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, run, softened
  use kinds, only: wp
  use solids, only: solids_t
  use sticky_balls, only: r, m, k, a, near, far, sticky, sticky_by_area, modulus, with_ball, two_balls, gap, parting, well, &
    sticking_speed
  implicit none

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

  subroutine forces_by_distance()
    real(wp), parameter :: n(3) = [0.36_wp, 0.48_wp, 0.8_wp], radii(2) = [40.0e-6_wp, 70.0e-6_wp]
    real(wp), parameter :: gap(6) = [-1.0e-7_wp, 0.5e-8_wp, 2.0e-8_wp, 1.0e-7_wp, 0.99e-6_wp, 1.01e-6_wp]
    type(cohesion_t) :: law
    real(wp) :: pair(4, lanes), force(3, lanes), curvature(lanes), width, pull(6)
    integer :: i

    width = product(radii)/sum(radii)
    curvature = 1/width
    do i = 1, lanes
      pair(:, i) = [(sum(radii) + gap(min(i, 6)))*n, sum(radii)]
    end do
    law = cohesion_t(.true., .true., a/6, near, far)
    call attractions(law, lanes, pair, curvature, force)
    pull = a*width/6*[1/near**2, 1/near**2, 1/gap(3)**2, 1/gap(4)**2, 1/gap(5)**2, 0.0_wp]
    do i = 1, 6
      call expect_close(norm2(force(:, i) + pull(i)*n), 0.0_wp, 1.0e-6_wp*max(pull(i), tiny(pull)), &
                        'van der Waals: A R/(6 h^2) between its limits')
    end do
    law = cohesion_t(.true., .false., pi*5.0e3_wp, 0.0_wp, 0.0_wp)
    call attractions(law, lanes, pair, curvature, force)
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
      ball = with_ball(comm, sticky(0.5_wp), -share*most/m, [0.0_wp, 0.0_wp, 0.5e-3_wp - r + dent], [0.0_wp, 0.0_wp, 0.0_wp])
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
      ball = with_ball(comm, contact, -share*most/m, [0.0_wp, 0.0_wp, 0.5e-3_wp - r + 4*rest/9], [0.0_wp, 0.0_wp, 0.0_wp])
      call run(ball, nint(5.0e-3_wp/ball%time_step_limit()), ball%time_step_limit())
      call expect(ball%parcels%state(3, 1) > 1.0e-3_wp - r .eqv. i == 1, 'by area a ball hangs, too, if it is light')
    end do
    ball = with_ball(comm, contact, 0.0_wp, [0.0_wp, 0.0_wp, 0.5e-3_wp - r + 4*rest/9], [0.0_wp, 0.0_wp, 0.0_wp])
    call run(ball, nint(5.0e-3_wp/ball%time_step_limit()), ball%time_step_limit())
    call expect_close(ball%parcels%state(3, 1) - 1.0e-3_wp + r, rest, 1.0e-6_wp, 'at rest it overlaps by r (3 pi k/(4 E))^2')
  end subroutine hangs_by_area

  subroutine escapes(of_wall)
    logical, intent(in) :: of_wall

    type(solids_t) :: balls
    real(wp) :: width, mass, critical, speed, dt
    integer :: i, step

    width = merge(r, r/2, of_wall)
    mass = merge(m, m/2, of_wall)
    critical = sqrt(2*sum(well(width))/mass)
    do i = 1, 2
      speed = merge(0.99_wp, 1.01_wp, i == 1)*critical
      if (of_wall) then
        balls = with_ball(comm, sticky(1.0_wp), 0.0_wp, [0.0_wp, 0.0_wp, r - 0.5e-3_wp - a*width/(6*near**2)/k], &
                          [0.0_wp, 0.0_wp, speed])
      else
        balls = two_balls(comm, sticky(1.0_wp), -a*width/(6*near**2)/k, speed)
      end if
      dt = 0.2_wp*balls%time_step_limit()
      do step = 1, nint(20*far/critical/dt)
        call run(balls, 1, dt)
        if (gap(balls) > far) exit
      end do
      call expect(gap(balls) > far .eqv. i == 2, merge('a ball parts from a wall above its escape velocity', &
                                                       'two balls part above their escape velocity        ', of_wall))
      if (i == 2) call expect_close(parting(balls), sqrt(speed**2 - critical**2), 3.0e-3_wp, 'with what is left of it')
    end do
  end subroutine escapes

  !> The same by area: 1/10 (pi k R)^5/(4/3 E sqrt(R))^4.
  subroutine escapes_by_area()
    type(contact_settings_t) :: contact
    type(solids_t) :: balls
    real(wp) :: e, rest, critical, speed, dt
    integer :: i

    contact = sticky_by_area(1.0_wp)
    e = modulus(contact)
    rest = r/2*(3*pi*contact%cohesion_energy/(4*e))**2
    critical = sqrt(2*0.1_wp*(pi*contact%cohesion_energy*r/2)**5/(4*e*sqrt(r/2)/3)**4/(m/2))
    do i = 1, 2
      speed = merge(0.98_wp, 1.02_wp, i == 1)*critical
      balls = two_balls(comm, contact, -rest, speed)
      dt = 0.2_wp*balls%time_step_limit()
      call run(balls, nint(20*rest/critical/dt), dt)
      call expect(gap(balls) > 0.0_wp .eqv. i == 2, 'by area two balls part above their escape velocity')
    end do
  end subroutine escapes_by_area

  !> Balls that meet below a certain speed stay together.
  subroutine agglomerates()
    real(wp), parameter :: e = 0.6_wp
    type(solids_t) :: balls
    real(wp) :: critical, dt, nearest
    integer :: i, step

    critical = sticking_speed(e)
    call expect(critical > 1.0e-3_wp .and. critical < 0.1_wp, 'there is such a speed')
    do i = 1, 2
      balls = two_balls(comm, sticky(e), 1.1_wp*far, -merge(0.97_wp, 1.03_wp, i == 1)*critical)
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

  !> Friction sees the repulsion that balances the attraction: a ball without weight slides on a floor by mu F/m.
  subroutine friction_of_attraction()
    real(wp), parameter :: mu = 0.3_wp, e = 0.5_wp, u = 0.01_wp, f = a*r/(6*near**2)
    type(contact_settings_t) :: contact
    type(solids_t) :: ball
    real(wp) :: dt

    contact = sticky(e)
    contact%friction = mu
    ball = with_ball(comm, contact, 0.0_wp, [0.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 0.0_wp, 0.0_wp])
    dt = ball%time_step_limit()
    ball = with_ball(comm, contact, 0.0_wp, [-2.0e-4_wp, 0.0_wp, r - f/softened(k, m, e, dt) - 0.5e-3_wp], [u, 0.0_wp, 0.0_wp])
    call run(ball, nint(0.1_wp*u*m/(mu*f)/dt), dt)
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
    real(wp) :: one(3, lanes), parcels(3, lanes), pair(4, lanes)
    integer :: i

    do i = 1, 2
      pair = spread([2*r + i*near, 0.0_wp, 0.0_wp, 2*r], 2, lanes)
      law = cohesion_t(.true., .true., a/6, near, far)
      call attractions(law, lanes, pair, spread(2/r, 1, lanes), one)
      pair = spread([6*r + i*near, 0.0_wp, 0.0_wp, 6*r], 2, lanes)
      law%strength = 9*a/6
      call attractions(law, lanes, pair, spread(2/(3*r), 1, lanes), parcels)
      call expect_close(parcels(1, 1), 27*one(1, 1), 1.0e-6_wp, 'parcels of 27 attract each other as 27 pairs')
    end do
  end subroutine weight_of_27

end program test_cohesion
