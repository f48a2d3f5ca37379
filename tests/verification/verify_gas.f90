!> Many parcels without walls: what a gas of them keeps, and how fast it cools.
program verify_gas
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use check, only: finish
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: cloud, put, run, scene
  use kinds, only: wp
  use random_numbers, only: new_random, random_t
  use report, only: check_value, point
  use solids, only: solids_t
  implicit none

  real(wp), parameter :: diameter = 1.0e-3_wp, density = 2500.0_wp, temperature = 1.0_wp  !< <v^2>/3 [m2/s2]
  real(wp), parameter :: mass = density*pi/6*diameter**3
  type(communicator_t) :: comm

  call start_ranks(comm)
  call elastic_gas()
  call closed_cloud()
  call cooling(0.90_wp, 0.05_wp)
  call cooling(0.90_wp, 0.10_wp)
  call cooling(0.90_wp, 0.15_wp)
  call cooling(0.95_wp, 0.05_wp)
  call cooling(0.95_wp, 0.10_wp)
  call cooling(0.95_wp, 0.15_wp)
  call finish()
  call stop_ranks()

contains

  !> How often a parcel collides in an elastic gas of hard spheres, by Enskog, 4 n d^2 g_0 sqrt(pi T), with the contact
  !> value of Carnahan and Starling, g_0 = (1 - phi/2)/(1 - phi)^3 [1/s]. Chapman & Cowling, The Mathematical Theory of
  !> Non-uniform Gases, Cambridge 1970, sec. 5.21 and 16.2; Carnahan & Starling, J. Chem. Phys. 51 (1969) 635.
  pure function collision_rate(solids_fraction) result(rate)
    real(wp), intent(in) :: solids_fraction  !< [-]
    real(wp) :: rate

    rate = 24/diameter*solids_fraction*(1 - solids_fraction/2)/(1 - solids_fraction)**3*sqrt(temperature/pi)
  end function collision_rate

  !> side^3 equal parcels in a periodic cube, on a jittered lattice, with normally distributed velocities and no
  !> momentum. A collision lasts `share` of the time between two of a parcel.
  function gas(side, solids_fraction, restitution, share, seed) result(solids)
    integer, intent(in) :: side, seed
    real(wp), intent(in) :: solids_fraction, restitution, share  !< [-]
    type(solids_t) :: solids

    type(contact_settings_t) :: contact
    type(random_t) :: numbers
    real(wp) :: x(3, side**3), v(3, side**3), d(side**3), rho(side**3), pitch, u(3)
    integer :: n, i, a

    n = side**3
    numbers = new_random(seed, 1)
    pitch = diameter*(pi/(6*solids_fraction))**(1.0_wp/3.0_wp)
    do i = 1, n
      x(:, i) = [modulo(i - 1, side), modulo((i - 1)/side, side), (i - 1)/side**2]
      do a = 1, 3
        u = [numbers%uniform(), numbers%uniform(), numbers%uniform()]
        x(a, i) = pitch*(x(a, i) + 0.5_wp) + (pitch - diameter)*(u(1) - 0.5_wp)/2
        v(a, i) = sqrt(-2*log(1 - u(2)))*cos(2*pi*u(3))
      end do
    end do
    v = v - spread(sum(v, 2)/n, 2, n)
    v = v*sqrt(3*n*temperature/sum(v**2))
    contact%restitution = restitution
    contact%stiffness = 0.5_wp*mass*(pi*collision_rate(solids_fraction)/share)**2
    solids = scene(comm, [side, side, side]*pitch, 0.0_wp, contact, [.true., .true., .true.])
    d = diameter
    rho = density
    call put(solids, x, v, d, density=rho)
  end function gas

  !> A hundred thousand elastic collisions, 5 % fewer than Enskog's because they take time: energy, momentum, and how
  !> often parcels collide.
  subroutine elastic_gas()
    integer, parameter :: side = 16, samples = 250
    real(wp), parameter :: solids_fraction = 0.1_wp, share = 0.05_wp, collisions = 1.06e5_wp
    type(solids_t) :: solids
    real(wp) :: start(4), now(4), drift, dt, touching, contacts, momentum
    integer :: sample, steps

    solids = gas(side, solids_fraction, 1.0_wp, share, 1)
    dt = solids%time_step_limit()
    steps = nint(2*collisions/(side**3*collision_rate(solids_fraction)*dt*samples))
    start = books(solids, contacts)
    drift = 0
    touching = 0
    do sample = 1, samples
      call run(solids, steps, dt)
      now = books(solids, contacts)
      touching = touching + contacts/samples
      drift = merge(now(4)/start(4) - 1, drift, abs(now(4)/start(4) - 1) > abs(drift))
      call point('elastic_energy', collisions*sample/samples, now(4)/start(4) - 1, 0.0_wp)
    end do
    momentum = norm2(now(1:3) - start(1:3))/sqrt(2*start(4)*side**3*mass)
    call check_value('gas_energy', drift, 0.0_wp)
    call check_value('gas_momentum', momentum, 0.0_wp)
    call check_value('gas_collisions', touching*solids%time/(20*dt), collisions)
  end subroutine elastic_gas

  !> Momentum [kg m/s] and energy, that of the springs included [J], and the number of pairs that touch.
  function books(solids, contacts) result(sums)
    type(solids_t), intent(in) :: solids
    real(wp), intent(out) :: contacts
    real(wp) :: sums(4)

    real(wp) :: overlap, once
    integer :: i, entry

    sums = 0
    contacts = 0
    associate (s => solids%parcels%state, list => solids%list)
      do i = 1, solids%parcels%n
        sums(1:3) = sums(1:3) + s(5:7, i)/s(8, i)
        sums(4) = sums(4) + sum(s(5:7, i)**2)/s(8, i)/2
        do entry = list%first(i), list%first(i + 1) - 1
          overlap = s(4, i) + s(4, list%partner(entry)) - norm2(s(1:3, i) - s(1:3, list%partner(entry)))
          if (overlap <= 0) cycle
          ! A pair across a periodic face is listed with each of the two.
          once = merge(0.5_wp, 1.0_wp, list%partner(entry) > solids%parcels%n)
          contacts = contacts + once
          sums(4) = sums(4) + once*solids%contact%stiffness*overlap**2/2
        end do
      end do
    end associate
  end function books

  !> Rough parcels that meet far from walls keep momentum and angular momentum, that of orbits and spins together.
  subroutine closed_cloud()
    type(solids_t) :: solids
    type(contact_settings_t) :: contact
    real(wp), allocatable :: x(:,:), v(:,:), d(:)
    real(wp) :: before(6), after(6), momentum, spin
    integer :: i

    contact%stiffness = 200.0_wp
    contact%friction = 0.4_wp
    call cloud(500, [0.02_wp, 0.02_wp, 0.02_wp], 1.25e-3_wp, [8, 8], x, v, d)
    v = v - 60.0_wp*(x - 0.025_wp)
    solids = scene(comm, [0.05_wp, 0.05_wp, 0.05_wp], 0.0_wp, contact)
    call put(solids, x, v, d)
    before = momenta(solids)
    momentum = 0
    spin = 0
    do i = 1, 500
      momentum = momentum + norm2(v(:, i))*2500*pi/6*d(i)**3
      spin = spin + norm2(v(:, i))*norm2(x(:, i) - 0.025_wp)*2500*pi/6*d(i)**3
    end do
    call run(solids, 2000, solids%time_step_limit())
    after = momenta(solids)
    call check_value('cloud_momentum', norm2(after(1:3) - before(1:3))/momentum, 0.0_wp)
    call check_value('cloud_angular_momentum', norm2(after(4:6) - before(4:6))/spin, 0.0_wp)
  end subroutine closed_cloud

  !> Momentum and angular momentum about the middle of the cloud.
  function momenta(solids) result(sums)
    type(solids_t), intent(in) :: solids
    real(wp) :: sums(6)

    real(wp) :: arm(3), p(3)
    integer :: i

    sums = 0
    do i = 1, solids%parcels%n
      associate (s => solids%parcels%state(:, i))
        arm = s(1:3) - 0.025_wp
        p = s(5:7)/s(8)
        sums(1:3) = sums(1:3) + p
        sums(4:6) = sums(4:6) + [arm(2)*p(3) - arm(3)*p(2), arm(3)*p(1) - arm(1)*p(3), arm(1)*p(2) - arm(2)*p(1)] &
                    + 0.4_wp*s(4)*s(9:11)/s(8)
      end associate
    end do
  end function momenta

  !> A gas left alone cools as T = T_0/(1 + t/t_0)^2, so 1/sqrt(T) grows steadily, by c/d with c = (1 - e^2)/3
  !> 2 sqrt(pi) n d^3 g_0. Haff, J. Fluid Mech. 134 (1983) 401-430; Lun, Savage, Jeffrey & Chepurniy, J. Fluid Mech. 140
  !> (1984) 223-256. The mean of three gases, since each cools as its collisions happen to come.
  subroutine cooling(restitution, solids_fraction)
    real(wp), intent(in) :: restitution, solids_fraction  !< [-]

    integer, parameter :: side = 14, samples = 60, gases = 3
    real(wp), parameter :: share = 0.03_wp, end_over_t_0 = 0.6_wp
    type(solids_t) :: solids(gases)
    real(wp) :: dt, expected, t(samples), y(samples), end_time
    integer :: sample, steps, m
    character(len=24) :: name

    write (name, '(a,f4.2,a,f4.2)') 'haff_e', restitution, '_phi', solids_fraction
    do m = 1, gases
      solids(m) = gas(side, solids_fraction, restitution, share, m)
    end do
    expected = (1 - restitution**2)/6*diameter*collision_rate(solids_fraction)/sqrt(temperature)
    dt = solids(1)%time_step_limit()
    end_time = end_over_t_0*diameter/(expected*sqrt(temperature))
    steps = nint(end_time/dt/samples)
    do sample = 1, samples
      y(sample) = 0.0_wp
      do m = 1, gases
        call run(solids(m), steps, dt)
        y(sample) = y(sample) + 1/sqrt(sum(solids(m)%parcels%state(5:7, 1:side**3)**2)/(3*side**3))/gases
      end do
      t(sample) = solids(1)%time
      call point(trim(name), t(sample)*expected*sqrt(temperature)/diameter, 1/(y(sample)**2*temperature), &
                 1/(1 + t(sample)*expected*sqrt(temperature)/diameter)**2)
    end do
    associate (from_rest => t(6:) - sum(t(6:))/size(t(6:)))
      call check_value(trim(name), diameter*sum(from_rest*y(6:))/sum(from_rest**2), expected)
    end associate
  end subroutine cooling

end program verify_gas
