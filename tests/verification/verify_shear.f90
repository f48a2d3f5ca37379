!> A granular gas in simple shear, u_x = rate y, against the kinetic theory of Lun, Savage, Jeffrey & Chepurniy, J. Fluid
!> Mech. 140 (1984) 223-256, with the contact value of Carnahan & Starling and the balance of energy closed.
!>
!> The box is periodic along x and z. Above it lies the same box, moved by rate L t along x and faster by rate L (Lees &
!> Edwards, J. Phys. C 5 (1972) 1921): every parcel has a copy there, or in the box below where that is nearer, which is made
!> anew from it before each step. Contacts, lists and motion are the program's own.
program verify_shear
  use chamber, only: chamber_t
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use check, only: expect, finish
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: put, run
  use des_settings, only: des_settings_t
  use kinds, only: wp
  use outcome, only: outcome_t
  use random_numbers, only: new_random, random_t
  use report, only: check_value, point
  use solids, only: solids_t
  use spring_contact, only: damping_ratio
  implicit none

  integer, parameter :: side = 8, n = side**3
  real(wp), parameter :: d = 1.0e-3_wp, density = 2500.0_wp, mass = density*pi/6*d**3
  real(wp), parameter :: temperature = 1.0_wp  !< expected, a third of the mean square of the velocities [m2/s2]

  !> A gas in shear.
  type :: shear_t
    type(solids_t) :: solids
    real(wp) :: rate = 0, edge = 0      !< [1/s], [m]
    real(wp) :: restitution = 0         !< [-]
    integer :: place(2*n) = 0           !< columns of the parcels, then of their copies
    integer :: above(n) = 1             !< 1 where the copy lies above, -1 below
  end type shear_t

  type(communicator_t) :: comm

  call start_ranks(comm)
  call sheared(0.9_wp, 0.1_wp, 6.596929104_wp, 0.2840329424_wp, 0.9863721156_wp)
  call sheared(0.9_wp, 0.2_wp, 1.965510863_wp, 0.2492330447_wp, 0.9182621063_wp)
  call sheared(0.9_wp, 0.3_wp, 1.210250655_wp, 0.3819796403_wp, 1.38878909_wp)
  call finish()
  call stop_ranks()

contains

  !> Temperature over (rate d)^2, shear stress and pressure over rho (rate d)^2 in the mean over `strain` after as much as
  !> it takes to forget the start.
  subroutine sheared(restitution, solids_fraction, t_star, stress_star, p_star)
    real(wp), intent(in) :: restitution, solids_fraction     !< [-]
    real(wp), intent(in) :: t_star, stress_star, p_star      !< expected [-]

    real(wp), parameter :: forgotten = 5.0_wp, strain = 45.0_wp
    integer, parameter :: samples = 750, often = 4
    type(shear_t) :: gas
    real(wp) :: dt, now(3), mean(3)
    integer :: sample, steps, step, taken
    character(len=24) :: name

    gas%rate = sqrt(temperature/t_star)/d
    call make(gas, restitution, solids_fraction)
    dt = gas%solids%time_step_limit()
    steps = ceiling((forgotten + strain)/(gas%rate*dt*samples*often))
    dt = (forgotten + strain)/(gas%rate*steps*samples*often)
    mean = 0
    taken = 0
    write (name, '(a,f4.2)') 'shear_phi', solids_fraction
    do sample = 1, samples
      do step = 1, steps*often
        call follow(gas, step == 1)
        call run(gas%solids, 1, dt)
        if (modulo(step, often) > 0) cycle
        call follow(gas, .false.)
        now = measure(gas)
        if (gas%rate*gas%solids%time < forgotten) cycle
        mean = mean + now
        taken = taken + 1
      end do
      call point(trim(name), gas%rate*gas%solids%time, now(1), t_star)
    end do
    mean = mean/taken
    call expect(gas%solids%parcels%n == 2*n, 'all parcels are there')
    call check_value(trim(name)//'_temperature', mean(1), t_star)
    call check_value(trim(name)//'_stress', mean(2), stress_star)
    call check_value(trim(name)//'_pressure', mean(3), p_star)
    call check_value(trim(name)//'_ratio', mean(2)/mean(3), stress_star/p_star)
  end subroutine sheared

  !> Parcels on a jittered lattice with normally distributed velocities upon those of the shear, and their copies. A
  !> collision lasts 0.05 of the time between two of a parcel.
  subroutine make(gas, restitution, solids_fraction)
    type(shear_t), intent(inout) :: gas
    real(wp), intent(in) :: restitution, solids_fraction  !< [-]

    type(contact_settings_t) :: contact
    type(chamber_t) :: chamber
    type(random_t) :: numbers
    real(wp) :: x(3, 2*n), v(3, 2*n), pitch, u(3), frequency
    integer :: i, a

    numbers = new_random(1, 1)
    pitch = d*(pi/(6*solids_fraction))**(1.0_wp/3.0_wp)
    gas%edge = side*pitch
    gas%restitution = restitution
    do i = 1, n
      x(:, i) = [modulo(i - 1, side), modulo((i - 1)/side, side), (i - 1)/side**2]
      do a = 1, 3
        u = [numbers%uniform(), numbers%uniform(), numbers%uniform()]
        x(a, i) = pitch*(x(a, i) + 0.5_wp) + (pitch - d)*(u(1) - 0.5_wp)/2
        v(a, i) = sqrt(-2*log(1 - u(2)))*cos(2*pi*u(3))
      end do
    end do
    v(:, 1:n) = v(:, 1:n) - spread(sum(v(:, 1:n), 2)/n, 2, n)
    v(:, 1:n) = v(:, 1:n)*sqrt(3*n*temperature/sum(v(:, 1:n)**2))
    v(1, 1:n) = v(1, 1:n) + gas%rate*(x(2, 1:n) - gas%edge/2)
    x(:, n + 1:) = x(:, 1:n)
    x(2, n + 1:) = x(2, n + 1:) + gas%edge
    v(:, n + 1:) = v(:, 1:n)
    frequency = 24/d*solids_fraction*(1 - solids_fraction/2)/(1 - solids_fraction)**3*sqrt(temperature/pi)
    contact%restitution = restitution
    contact%stiffness = 0.5_wp*mass*(pi*frequency/0.05_wp)**2
    chamber%lower = [0.0_wp, -0.6_wp, 0.0_wp]*gas%edge
    chamber%upper = [1.0_wp, 2.1_wp, 1.0_wp]*gas%edge
    chamber%periodic = [.true., .false., .true.]
    call gas%solids%create(comm, chamber, contact, des_settings_t(), .false., 0.0_wp)
    call put(gas%solids, x, v, [(d, i=1, 2*n)], density=[(density, i=1, 2*n)])
  end subroutine make

  !> Make the copies anew; with `settle` parcels that have left the box come back on the other side first, copies go where they
  !> are nearer, and lists are made.
  subroutine follow(gas, settle)
    type(shear_t), intent(inout) :: gas
    logical, intent(in) :: settle

    type(outcome_t) :: outcome
    real(wp) :: gone, faster, jump(3)
    integer :: i

    faster = gas%rate*gas%edge
    gone = modulo(faster*gas%solids%time, gas%edge)
    associate (p => gas%solids%parcels)
      do i = 1, p%n
        gas%place(p%id(i)) = i
      end do
      do i = 1, n
        associate (own => gas%place(i), copy => gas%place(n + i))
          if (settle) then
            associate (out => floor(p%state(2, own)/gas%edge))
              p%state(1:2, own) = p%state(1:2, own) - out*[gone, gas%edge]
              p%state(5, own) = p%state(5, own) - out*faster
            end associate
            gas%above(i) = merge(1, -1, p%state(2, own) < gas%edge/2)
          end if
          jump = p%state(1:3, own) + gas%above(i)*[gone, gas%edge, 0.0_wp] - p%state(1:3, copy)
          jump([1, 3]) = jump([1, 3]) - gas%edge*nint(jump([1, 3])/gas%edge)
          p%state(1:3, copy) = p%state(1:3, copy) + jump
          p%state(5:7, copy) = p%state(5:7, own) + gas%above(i)*[faster, 0.0_wp, 0.0_wp]
          p%aside(:, copy) = p%aside(:, own)
        end associate
      end do
    end associate
    if (settle) call gas%solids%renew_lists(outcome)
    if (outcome%failed()) call expect(.false., outcome%message)
  end subroutine follow

  !> Temperature over (rate d)^2, shear stress and pressure over rho (rate d)^2: of the motion about the mean, and of the
  !> contacts, sum of F r/V. A contact with a copy or across a periodic face is met twice, one with both four times.
  function measure(gas) result(found)
    type(shear_t), intent(in) :: gas
    real(wp) :: found(3)

    real(wp) :: c(3), moving, stress, pressure, r(3), f(3), once
    integer :: i, entry, j

    moving = 0
    stress = 0
    pressure = 0
    associate (p => gas%solids%parcels, list => gas%solids%list)
      do i = 1, p%n
        if (p%id(i) > n) cycle
        c = p%state(5:7, i)
        c(1) = c(1) - gas%rate*(p%state(2, i) - gas%edge/2)
        moving = moving + sum(c**2)/(3*n)
        stress = stress - mass*c(1)*c(2)
        pressure = pressure + mass*sum(c**2)/3
      end do
      do i = 1, p%n
        do entry = list%first(i), list%first(i + 1) - 1
          j = list%partner(entry)
          r = p%state(1:3, i) - p%state(1:3, j)
          if (sum(r**2) >= d**2 .or. min(p%id(i), p%id(j)) > n) cycle
          once = merge(0.5_wp, 1.0_wp, max(p%id(i), p%id(j)) > n)*merge(0.5_wp, 1.0_wp, j > p%n)
          f = force(gas, r, p%state(5:7, i) - p%state(5:7, j))
          stress = stress - once*f(1)*r(2)
          pressure = pressure + once*dot_product(f, r)/3
        end do
      end do
    end associate
    found = [moving/(gas%rate*d)**2, [stress, pressure]/gas%edge**3/(density*(gas%rate*d)**2)]
  end function measure

  !> Of spring and dashpot on a parcel, its partner's centre being at -r and moving by -v [N].
  pure function force(gas, r, v) result(f)
    type(shear_t), intent(in) :: gas
    real(wp), intent(in) :: r(3), v(3)  !< [m], [m/s]
    real(wp) :: f(3)

    real(wp) :: normal(3), damping

    normal = r/norm2(r)
    associate (k => gas%solids%contact%stiffness)
      damping = 2*damping_ratio(gas%restitution)*sqrt(k*mass/2)
      f = (k*(d - norm2(r)) - damping*dot_product(v, normal))*normal
    end associate
  end function force

end program verify_shear
