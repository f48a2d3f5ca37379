!> Contacts of two parcels and of a parcel and a wall against closed formulas.
!> ranks: 1
program test_des_contact
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, place_of, run, softened
  use kinds, only: wp
  use motion, only: start_lead
  use parcels, only: parcels_t
  use solids, only: solids_t
  implicit none

  type(communicator_t) :: comm
  real(wp), parameter :: still(3, 2) = 0.0_wp

  call start_ranks(comm)
  call bounce(restitution=0.9_wp)
  call bounce(restitution=0.5_wp)
  call rest_on_wall()
  call sliding_to_rolling()
  call collision([1.0e-3_wp, 1.0e-3_wp], [1.0_wp, 1.0_wp], 0.9_wp, 'equal')
  call collision([1.0e-3_wp, 1.7e-3_wp], [1.0_wp, 1.0_wp], 0.7_wp, 'unequal')
  call collision([1.0e-3_wp, 0.5e-3_wp], [1.0_wp, 27.0_wp], 0.8_wp, 'of unequal weight')
  call first_lead()
  call coarse_steps(0.9_wp)
  call coarse_steps(0.5_wp)
  call coarse_steps(0.3_wp)
  call time_step()
  call oblique_sliding()
  call without_friction()
  call weight_of_eight()
  call finish()
  call stop_ranks()

contains

  function linear(stiffness, restitution, friction) result(contact)
    real(wp), intent(in) :: stiffness, restitution, friction
    type(contact_settings_t) :: contact

    contact%stiffness = stiffness
    contact%restitution = restitution
    contact%friction = friction
  end function linear

  pure function mass_of(diameter, weight) result(mass)
    real(wp), intent(in) :: diameter, weight
    real(wp) :: mass

    mass = weight*2500*pi/6*diameter**3
  end function mass_of

  !> A ball falls, and leaves the wall e times as fast as it came, after pi/omega_d, having gone in by
  !> v/omega_0 exp(-zeta/sqrt(1-zeta^2) acos(zeta)).
  subroutine bounce(restitution)
    real(wp), intent(in) :: restitution

    real(wp), parameter :: height = 2.0e-3_wp, g = 9.81_wp, radius = 0.5e-3_wp, k = 5.0e4_wp
    type(solids_t) :: ball
    real(wp) :: dt, v_in, omega, zeta, deepest, began, ended, v_out, z, before

    ball = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], -g, linear(k, restitution, 0.3_wp))
    call put(ball, reshape([0.005_wp, 0.005_wp, radius + height], [3, 1]), still(:, 1:1), [2*radius])
    zeta = -log(restitution)/sqrt(pi**2 + log(restitution)**2)
    omega = sqrt(k/mass_of(2*radius, 1.0_wp))
    v_in = sqrt(2*g*height)
    dt = pi/omega/400
    deepest = radius
    began = 0
    ended = 0
    before = height + radius
    do
      call run(ball, 1, dt)
      z = ball%parcels%state(3, 1)
      if (z < radius .and. before >= radius) began = ball%time - dt*(radius - z)/(before - z)
      if (z >= radius .and. before < radius) ended = ball%time - dt*(z - radius)/(z - before)
      deepest = min(deepest, z)
      before = z
      if (ended > 0.0_wp) exit
    end do
    v_out = ball%parcels%state(7, 1)
    call expect_close(began, sqrt(2*height/g), 2.0e-5_wp, 'a fall takes sqrt(2h/g)')
    call expect_close(v_out/v_in, restitution, 1.0e-3_wp, 'a wall gives the restitution asked for')
    call expect_close(ended - began, pi/(omega*sqrt(1 - zeta**2)), 2.0e-3_wp, 'a bounce takes pi/omega_d')
    call expect_close(radius - deepest, v_in/omega*exp(-zeta/sqrt(1 - zeta**2)*acos(zeta)), 2.0e-3_wp, &
                      'the overlap is that of the damped oscillator')
  end subroutine bounce

  !> A ball on a wall sinks in by m g/k, whatever the damping, for a spring as soft as the step makes it.
  subroutine rest_on_wall()
    real(wp), parameter :: radius = 0.5e-3_wp, k = 5.0_wp, e = 0.3_wp
    type(solids_t) :: ball
    real(wp) :: sag, dt

    ball = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], -9.81_wp, linear(k, e, 0.3_wp))
    call put(ball, reshape([0.005_wp, 0.005_wp, radius], [3, 1]), still(:, 1:1), [2*radius])
    dt = ball%time_step_limit()
    sag = mass_of(2*radius, 1.0_wp)*9.81_wp/softened(k, mass_of(2*radius, 1.0_wp), e, dt)
    call run(ball, 2000, dt)
    call expect_close(radius - ball%parcels%state(3, 1), sag, 1.0e-9_wp, 'a ball at rest sinks in by m g/k')
  end subroutine rest_on_wall

  !> A sliding ball rolls from mu g t/u_0 = 2/7 on, at u/u_0 = 5/7 (MFIX verification, DEM04).
  subroutine sliding_to_rolling()
    real(wp), parameter :: radius = 0.5e-3_wp, density = 1.0e4_wp, k = 1.0e4_wp
    real(wp), parameter :: u_0 = 0.1_wp, mu = 0.4_wp, g = 9.80665_wp
    type(solids_t) :: ball
    type(contact_settings_t) :: contact
    real(wp) :: dt, sag, u, spin, rolling
    integer :: step

    contact = linear(k, 1.0_wp, mu)
    contact%tangential_ratio = 1.0_wp
    ball = scene(comm, [0.05_wp, 0.01_wp, 0.01_wp], -g, contact)
    sag = density*pi/6*(2*radius)**3*g/k
    call put(ball, reshape([0.005_wp, 0.005_wp, radius - sag], [3, 1]), reshape([u_0, 0.0_wp, 0.0_wp], [3, 1]), &
             [2*radius], density=[density])
    dt = 0.4_wp*ball%time_step_limit()
    rolling = 0
    u = u_0
    spin = 0
    do step = 1, nint(0.45_wp*u_0/(mu*g)/dt)
      call run(ball, 1, dt)
      u = ball%parcels%state(5, 1)
      spin = ball%parcels%state(10, 1)
      if (rolling <= 0.0_wp .and. spin >= u) rolling = ball%time
    end do
    call expect_close(mu*g*rolling/u_0, 2.0_wp/7.0_wp, 2.0e-3_wp, 'sliding ends at mu g t/u_0 = 2/7')
    call expect_close(u/u_0, 5.0_wp/7.0_wp, 1.0e-4_wp, 'a ball rolls at 5/7 of its speed')
    call expect_close(spin/u, 1.0_wp, 1.0e-3_wp, 'a rolling ball does not slip')
  end subroutine sliding_to_rolling

  !> Two parcels meet head on: restitution, duration and overlap of the pair's own oscillator.
  subroutine collision(diameter, weight, restitution, which)
    real(wp), intent(in) :: diameter(2), weight(2), restitution
    character(len=*), intent(in) :: which

    real(wp), parameter :: k = 300.0_wp, speed = 0.2_wp
    type(solids_t) :: pair
    real(wp) :: x(3, 2), v(3, 2), m(2), radius(2), m_eff, omega, zeta, dt, gap, before, deepest
    real(wp) :: began, ended, apart
    integer :: i

    radius = 0.5_wp*diameter*weight**(1.0_wp/3.0_wp)
    m = [(mass_of(diameter(i), weight(i)), i=1, 2)]
    m_eff = product(m)/sum(m)
    x = 0.01_wp
    x(1, :) = 0.01_wp + [-1, 1]*1.001_wp*radius
    v = 0.0_wp
    v(1, :) = [0.75_wp, -0.25_wp]*speed
    pair = scene(comm, [0.02_wp, 0.02_wp, 0.02_wp], 0.0_wp, linear(k, restitution, 0.3_wp))
    call put(pair, x, v, diameter, weight)
    zeta = -log(restitution)/sqrt(pi**2 + log(restitution)**2)
    omega = sqrt(k/m_eff)
    dt = pi/omega/1000
    deepest = 0
    began = 0
    before = 1
    do
      call run(pair, 1, dt)
      associate (s => pair%parcels%state)
        gap = norm2(s(1:3, 1) - s(1:3, 2)) - sum(radius)
        apart = abs(s(5, 1) - s(5, 2))
      end associate
      if (gap < 0 .and. before >= 0) began = pair%time + dt*gap/(before - gap)
      if (gap >= 0 .and. before < 0) exit
      deepest = min(deepest, gap)
      before = gap
    end do
    ended = pair%time - dt*gap/(gap - before)
    call expect_close(apart/speed, restitution, 1.0e-3_wp, 'restitution of parcels '//which)
    call expect_close(ended - began, pi/(omega*sqrt(1 - zeta**2)), 1.0e-3_wp, 'contact time of parcels '//which)
    call expect_close(-deepest, speed/omega*exp(-zeta/sqrt(1 - zeta**2)*acos(zeta)), 1.0e-3_wp, &
                      'overlap of parcels '//which)
    associate (p => pair%parcels)
      call expect_close(sum(p%state(5, 1:2)/p%state(8, 1:2)), sum(m*v(1, :)), 1.0e-13_wp, &
                        'momentum of parcels '//which)
    end associate
  end subroutine collision

  !> The lead of the first step is half a step of the accelerations at its start; for spins, which are times the radius, 5/2 of
  !> torque over radius and mass.
  subroutine first_lead()
    real(wp), parameter :: dt = 1.0e-4_wp, mass = 2.0_wp, f(3) = [1.0_wp, -2.0_wp, 3.0_wp], t(3) = [-4.0_wp, 5.0_wp, 6.0_wp]
    real(wp), parameter :: down(3) = [0.0_wp, 0.0_wp, -9.81_wp]
    type(parcels_t) :: parcels

    call parcels%create(rotation=.true., with_gas=.false.)
    parcels%n = 1
    parcels%state(8, 1) = 1/mass
    call parcels%make_ring(1)
    parcels%force(parcels%force_at(1):parcels%force_at(1) + 7) = [f, 0.0_wp, t, 0.0_wp]
    call start_lead(parcels, [1, 1], down, dt)
    call expect_close(norm2(parcels%aside(1:3, 1) - dt/2*(f/mass + down))/dt, 0.0_wp, 1.0e-14_wp, 'the lead at the start')
    call expect_close(norm2(parcels%aside(5:7, 1) - dt/2*2.5_wp*t/mass)/dt, 0.0_wp, 1.0e-14_wp, 'and that of the spin')
    call expect(all(abs(parcels%force) <= 0.0_wp), 'after which the forces are forgotten')
  end subroutine first_lead

  !> With 20 steps in a collision restitution is still that asked for, on the mean over where in a step the
  !> collision begins.
  subroutine coarse_steps(e)
    real(wp), intent(in) :: e

    integer, parameter :: starts = 40
    real(wp), parameter :: radius = 0.5e-3_wp, speed = 0.2_wp
    type(solids_t) :: ball
    real(wp) :: v(3, 1), dt, mean
    integer :: m

    v(:, 1) = [0.0_wp, 0.0_wp, -speed]
    mean = 0
    do m = 1, starts
      ball = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], 0.0_wp, linear(500.0_wp, e, 0.3_wp))
      dt = pi*sqrt(mass_of(2*radius, 1.0_wp)/500*(1 + (log(e)/pi)**2))/20
      call put(ball, reshape([0.005_wp, 0.005_wp, radius + dt*speed*(1 + (m - 0.5_wp)/starts)], [3, 1]), v, &
               [2*radius])
      call run(ball, 40, dt)
      mean = mean + ball%parcels%state(7, 1)/speed/starts
    end do
    call expect_close(mean/e, 1.0_wp, 5.0e-4_wp, 'restitution with 20 steps in a collision')
  end subroutine coarse_steps

  !> The step is the contact time of the two lightest parcels over the steps asked for.
  subroutine time_step()
    type(solids_t) :: pair
    type(contact_settings_t) :: contact
    real(wp) :: omega, zeta

    contact = linear(100.0_wp, 0.5_wp, 0.0_wp)
    pair = scene(comm, [0.02_wp, 0.02_wp, 0.02_wp], 0.0_wp, contact)
    call put(pair, reshape([0.005_wp, 0.005_wp, 0.005_wp, 0.01_wp, 0.01_wp, 0.01_wp], [3, 2]), still, &
             [1.0e-3_wp, 2.0e-3_wp])
    omega = sqrt(100.0_wp/(0.5_wp*mass_of(1.0e-3_wp, 1.0_wp)))
    zeta = log(2.0_wp)/sqrt(pi**2 + log(2.0_wp)**2)
    call expect_close(pair%time_step_limit(), pi/(omega*sqrt(1 - zeta**2))/20, 1.0e-12_wp, &
                      'the step is t_c/20 of the lightest')
    contact%wall_stiffness = 1000.0_wp
    pair = scene(comm, [0.02_wp, 0.02_wp, 0.02_wp], 0.0_wp, contact)
    call put(pair, reshape([0.005_wp, 0.005_wp, 0.005_wp, 0.01_wp, 0.01_wp, 0.01_wp], [3, 2]), still, &
             [1.0e-3_wp, 2.0e-3_wp])
    omega = sqrt(1000.0_wp/mass_of(1.0e-3_wp, 1.0_wp))
    call expect_close(pair%time_step_limit(), pi/(omega*sqrt(1 - zeta**2))/20, 1.0e-12_wp, &
                      'a stiff wall shortens the step')
  end subroutine time_step

  !> A grazing elastic hit slides throughout: the wall takes 2 mu v_n from the tangential speed, and the spin
  !> gains 5/2 of that.
  subroutine oblique_sliding()
    real(wp), parameter :: radius = 0.5e-3_wp, mu = 0.2_wp, v_n = 0.02_wp, v_t = 1.0_wp
    type(solids_t) :: ball
    real(wp) :: dt, v(3, 1)
    integer :: step

    ball = scene(comm, [0.05_wp, 0.01_wp, 0.01_wp], 0.0_wp, linear(5000.0_wp, 1.0_wp, mu))
    v(:, 1) = [v_t, 0.0_wp, -v_n]
    call put(ball, reshape([0.005_wp, 0.005_wp, 1.001_wp*radius], [3, 1]), v, [2*radius])
    dt = 0.05_wp*ball%time_step_limit()
    do step = 1, 2000
      call run(ball, 1, dt)
      if (ball%parcels%state(3, 1) > radius .and. ball%parcels%state(7, 1) > 0) exit
    end do
    associate (s => ball%parcels%state(:, 1))
      call expect_close(v_t - s(5), 2*mu*v_n, 2.0e-3_wp, 'sliding takes mu times the normal impulse')
      call expect_close(s(10), 2.5_wp*(v_t - s(5)), 1.0e-3_wp, 'spin gains 5/2 of it')
    end associate
  end subroutine oblique_sliding

  !> Without friction a pair moves as with a friction of 0 and rotation switched on by the walls' friction.
  subroutine without_friction()
    type(solids_t) :: smooth, rough
    type(contact_settings_t) :: contact
    real(wp) :: x(3, 2), v(3, 2)
    integer :: i

    contact = linear(300.0_wp, 0.8_wp, 0.0_wp)
    smooth = scene(comm, [0.02_wp, 0.02_wp, 0.02_wp], 0.0_wp, contact)
    contact%wall_friction = 0.3_wp
    rough = scene(comm, [0.02_wp, 0.02_wp, 0.02_wp], 0.0_wp, contact)
    x = 0.01_wp
    x(:, 2) = [0.0108_wp, 0.0105_wp, 0.0104_wp]
    v(:, 1) = [0.2_wp, 0.1_wp, 0.0_wp]
    v(:, 2) = [-0.3_wp, 0.0_wp, 0.05_wp]
    call put(smooth, x, v, [1.0e-3_wp, 1.3e-3_wp])
    call put(rough, x, v, [1.0e-3_wp, 1.3e-3_wp])
    call expect(size(smooth%parcels%state, 1) == 8 .and. .not. allocated(smooth%pairs%record), &
                'without friction there is no spin and no history')
    call run(smooth, 60, smooth%time_step_limit())
    call run(rough, 60, rough%time_step_limit())
    do i = 1, 2
      call expect_close(norm2(smooth%parcels%state(5:7, place_of(smooth, i)) - &
                              rough%parcels%state(5:7, place_of(rough, i))), 0.0_wp, 1.0e-14_wp, &
                        'no friction is friction 0')
    end do
    call expect(norm2(smooth%parcels%state(5:7, place_of(smooth, 1)) - v(:, 1)) > 0.1_wp, 'and they did meet')
  end subroutine without_friction

  !> A parcel of eight particles of half the size is one particle of the whole size.
  subroutine weight_of_eight()
    type(solids_t) :: one, eight
    real(wp) :: x(3, 2), v(3, 2)
    integer :: i

    one = scene(comm, [0.02_wp, 0.02_wp, 0.02_wp], 0.0_wp, linear(300.0_wp, 0.8_wp, 0.3_wp))
    eight = scene(comm, [0.02_wp, 0.02_wp, 0.02_wp], 0.0_wp, linear(300.0_wp, 0.8_wp, 0.3_wp))
    x = 0.01_wp
    x(:, 2) = [0.0108_wp, 0.0105_wp, 0.0104_wp]
    v(:, 1) = [0.2_wp, 0.1_wp, 0.0_wp]
    v(:, 2) = [-0.3_wp, 0.0_wp, 0.05_wp]
    call put(one, x, v, [1.0e-3_wp, 1.2e-3_wp])
    call put(eight, x, v, [0.5e-3_wp, 0.6e-3_wp], [8.0_wp, 8.0_wp])
    call run(one, 60, one%time_step_limit())
    call run(eight, 60, one%time_step_limit())
    do i = 1, 2
      associate (a => one%parcels%state(:, place_of(one, i)), b => eight%parcels%state(:, place_of(eight, i)))
        call expect(all(abs(a - b) <= 1.0e-12_wp*max(abs(a), 1.0e-6_wp)), 'eight of half the size are one')
      end associate
    end do
  end subroutine weight_of_eight

end program test_des_contact
