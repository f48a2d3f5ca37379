!> Many parcels: the list misses no pair, momentum is kept, borders make no difference, a restart none either.
program test_des_many
  use check, only: expect_all, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, cloud, place_of, run
  use kinds, only: wp, i8
  use mpi_f08, only: MPI_COMM_SELF
  use outcome, only: outcome_t
  use solids, only: solids_t
  use solids_state, only: solids_state_t, export_state, import_state
  use solids_statistics, only: statistics_t, find_statistics
  implicit none

  type(communicator_t) :: comm, alone

  call start_ranks(comm)
  alone%handle = MPI_COMM_SELF
  call list_is_complete([.false., .false., .false.], 'walls')
  call list_is_complete([.true., .true., .false.], 'periodic faces')
  call closed_system()
  call across_a_face()
  call same_on_all_ranks(0.3_wp)
  call same_on_all_ranks(0.0_wp)
  call same_on_all_ranks(0.3_wp, 'spring')
  call restart(0.3_wp)
  call restart(0.0_wp)
  call restart(0.3_wp, 'spring')
  call attraction()
  call driven_by_gas()
  call through_open_face()
  call trouble()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  function material(friction, rolling) result(contact)
    real(wp), intent(in) :: friction
    character(len=*), intent(in), optional :: rolling
    type(contact_settings_t) :: contact

    contact%stiffness = 200.0_wp
    contact%friction = friction
    contact%rolling_friction = 0.1_wp
    if (.not. present(rolling)) return
    contact%rolling = rolling
    contact%cohesion = 'van_der_waals'
    contact%hamaker_constant = 1.0e-15_wp
    contact%minimum_separation = 1.0e-7_wp
    contact%maximum_separation = 2.0e-4_wp
  end function material

  !> A cloud of n parcels that falls into a corner of its chamber.
  subroutine falling(ranks, n, friction, periodic, solids, rolling)
    type(communicator_t), intent(in) :: ranks
    integer, intent(in) :: n
    real(wp), intent(in) :: friction
    logical, intent(in) :: periodic(3)
    type(solids_t), intent(out) :: solids
    character(len=*), intent(in), optional :: rolling

    real(wp), allocatable :: x(:,:), v(:,:), diameter(:)

    call cloud(n, [0.0_wp, 0.0_wp, 0.0_wp], 1.25e-3_wp, [8, 6], x, v, diameter)
    solids = scene(ranks, [0.01_wp, 0.0075_wp, 0.02_wp], -9.81_wp, material(friction, rolling), periodic)
    call put(solids, x, v, diameter)
  end subroutine falling

  !> Every pair closer than its radii is listed, and as often as it must be: compared with all pairs.
  subroutine list_is_complete(periodic, where)
    logical, intent(in) :: periodic(3)
    character(len=*), intent(in) :: where

    type(solids_t) :: solids
    type(statistics_t) :: s
    integer(i8) :: all
    integer :: i, j, a
    real(wp) :: way(3)
    real(wp), allocatable :: every(:,:)

    call falling(comm, 300, 0.3_wp, periodic, solids)
    solids%chamber%gravity(3) = -170.0_wp
    call run(solids, 1600, solids%time_step_limit())
    s = find_statistics(solids)
    call gather(solids, 300, every)
    all = 0
    do i = 1, 300
      do j = 1, i - 1
        way = abs(every(1:3, i) - every(1:3, j))
        do a = 1, 3
          if (periodic(a)) way(a) = min(way(a), solids%chamber%upper(a) - way(a))
        end do
        if (norm2(way) < every(4, i) + every(4, j)) all = all + 1
      end do
    end do
    call expect_all(s%contacts == all .and. all > 300, 'no pair is missed or seen twice between '//where)
    call expect_all(s%lost == 0 .and. s%parcels == 300 .and. s%rebuilds > 5, 'nor a parcel lost between '//where)
    call expect_all(s%max_overlap > 0.0_wp .and. s%max_overlap < 0.1_wp .and. s%mean_overlap < s%max_overlap, &
                    'overlaps are small between '//where)
  end subroutine list_is_complete

  !> State of all parcels by id, on all ranks, positions brought inside.
  subroutine gather(solids, n, every)
    type(solids_t), intent(in) :: solids
    integer, intent(in) :: n
    real(wp), allocatable, intent(out) :: every(:,:)

    real(wp) :: x(3)
    integer :: i

    allocate (every(size(solids%parcels%state, 1), n))
    every = 0.0_wp
    do i = 1, solids%parcels%n
      x = solids%parcels%state(1:3, i)
      call solids%tiles%wrap(x)
      every(:, solids%parcels%id(i)) = solids%parcels%state(:, i)
      every(1:3, solids%parcels%id(i)) = x
    end do
    do i = 1, size(every, 1)
      every(i, :) = solids%comm%sum(every(i, :))
    end do
  end subroutine gather

  !> Parcels that meet far from walls keep momentum and angular momentum, orbits and spins together, and lose
  !> energy.
  subroutine closed_system()
    type(solids_t) :: solids
    real(wp), allocatable :: x(:,:), v(:,:), diameter(:)
    real(wp) :: before(7), after(7), scale

    call cloud(200, [0.01_wp, 0.01_wp, 0.01_wp], 1.25e-3_wp, [6, 6], x, v, diameter)
    v = v - 60.0_wp*(x - 0.014_wp)
    solids = scene(comm, [0.03_wp, 0.03_wp, 0.03_wp], 0.0_wp, material(0.4_wp))
    call put(solids, x, v, diameter)
    before = momenta(solids)
    call run(solids, 500, solids%time_step_limit())
    after = momenta(solids)
    scale = sum(sqrt(before(7)/2.0e-6_wp)*[1.0e-6_wp])
    call expect_all(norm2(after(1:3) - before(1:3)) < 1.0e-12_wp*scale*200, 'a closed system keeps its momentum')
    call expect_all(norm2(after(4:6) - before(4:6)) < 1.0e-12_wp*scale*200*0.02_wp, 'and its angular momentum')
    call expect_all(after(7) < 0.7_wp*before(7), 'and loses energy')
  end subroutine closed_system

  !> Momentum, angular momentum about the origin, and twice the kinetic energy.
  function momenta(solids) result(sums)
    type(solids_t), intent(in) :: solids
    real(wp) :: sums(7)

    integer :: i

    sums = 0.0_wp
    do i = 1, solids%parcels%n
      associate (s => solids%parcels%state(:, i))
        sums(1:3) = sums(1:3) + s(5:7)/s(8)
        sums(4:6) = sums(4:6) + (cross(s(1:3), s(5:7)) + 0.4_wp*s(4)*s(9:11))/s(8)
        sums(7) = sums(7) + (sum(s(5:7)**2) + 0.4_wp*sum(s(9:11)**2))/s(8)
      end associate
    end do
    sums = solids%comm%sum(sums)
  end function momenta

  pure function cross(a, b) result(c)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: c(3)

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross

  !> Two parcels meet across a periodic face as they do inside.
  subroutine across_a_face()
    type(solids_t) :: inside, across
    real(wp) :: x(3, 2), v(3, 2)
    real(wp), allocatable :: a(:,:), b(:,:)

    x(:, 1) = [0.005_wp, 0.005_wp, 0.005_wp]
    x(:, 2) = [0.0058_wp, 0.0055_wp, 0.0052_wp]
    v(:, 1) = [0.3_wp, 0.1_wp, 0.0_wp]
    v(:, 2) = [-0.3_wp, 0.0_wp, 0.05_wp]
    inside = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], 0.0_wp, material(0.3_wp), [.true., .true., .true.])
    call put(inside, x, v, [1.0e-3_wp, 1.0e-3_wp])
    across = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], 0.0_wp, material(0.3_wp), [.true., .true., .true.])
    x(1, :) = modulo(x(1, :) + 0.0046_wp, 0.01_wp)
    x(3, :) = modulo(x(3, :) + 0.0049_wp, 0.01_wp)
    call put(across, x, v, [1.0e-3_wp, 1.0e-3_wp])
    call run(inside, 400, inside%time_step_limit())
    call run(across, 400, inside%time_step_limit())
    call gather(inside, 2, a)
    call gather(across, 2, b)
    call expect_all(all(abs(a(5:7, :) - b(5:7, :)) < 1.0e-11_wp), 'a contact across a periodic face is one inside')
    call expect_all(all(abs(a(9:11, :) - b(9:11, :)) < 1.0e-11_wp) .and. norm2(a(9:11, 1)) > 1.0e-3_wp, &
                    'and so is its spin')
    call expect_all(norm2(a(5:7, 1) - v(:, 1)) > 0.1_wp, 'and they did meet')
  end subroutine across_a_face

  !> All ranks together and each by itself compute the same fall.
  subroutine same_on_all_ranks(friction, rolling)
    real(wp), intent(in) :: friction
    character(len=*), intent(in), optional :: rolling

    type(solids_t) :: together, apart
    real(wp), allocatable :: a(:,:), b(:,:)
    logical :: near
    integer :: i

    near = .true.
    call falling(comm, 400, friction, [.true., .false., .false.], together, rolling)
    call falling(alone, 400, friction, [.true., .false., .false.], apart, rolling)
    do i = 1, 10
      call run(together, 25, apart%time_step_limit())
      near = near .and. are_near_home(together)
      call run(apart, 25, apart%time_step_limit())
    end do
    call gather(together, 400, a)
    call gather(apart, 400, b)
    call expect_all(together%tilings > 1 .or. comm%size == 1, 'tiles change hands when the load is uneven')
    call expect_all(apart%rebuilds > 2, 'lists are made anew while they fall')
    call expect_all(near, 'none goes astray further than it may')
    call expect_all(all(abs(a(1:3, :) - b(1:3, :)) < 1.0e-10_wp*0.01_wp), 'positions do not depend on the ranks')
    call expect_all(all(abs(a(5:7, :) - b(5:7, :)) < 1.0e-10_wp*0.5_wp), 'nor velocities')
    if (size(a, 1) > 8) call expect_all(all(abs(a(9:11, :) - b(9:11, :)) < 1.0e-10_wp*0.5_wp), 'nor spins')
  end subroutine same_on_all_ranks

  !> Whether all parcels are in the tiles of their rank, or not far from them.
  function are_near_home(solids) result(near)
    type(solids_t), intent(in) :: solids
    logical :: near

    real(wp) :: low(3), high(3), x(3), least
    integer :: i, k, side

    near = .true.
    do i = 1, solids%parcels%n
      least = huge(least)
      do side = -1, 1  ! the first direction is periodic
        x = solids%parcels%state(1:3, i) + [side*solids%chamber%upper(1), 0.0_wp, 0.0_wp]
        do k = 1, size(solids%tiles%mine)
          call solids%tiles%bounds(solids%tiles%mine(k), low, high)
          least = min(least, norm2(max(low - x, 0.0_wp, x - high)))
        end do
      end do
      near = near .and. least <= solids%largest_stray()
    end do
  end function are_near_home

  !> A run taken up from its exported state is the uninterrupted run, bit for bit.
  subroutine restart(friction, rolling)
    real(wp), intent(in) :: friction
    character(len=*), intent(in), optional :: rolling

    type(solids_t) :: whole, resumed
    type(solids_state_t) :: state
    type(outcome_t) :: outcome
    real(wp) :: dt

    call falling(comm, 400, friction, [.true., .false., .false.], whole, rolling)
    dt = whole%time_step_limit()
    call run(whole, 517, dt)
    call export_state(whole, state)
    resumed = scene(comm, [0.01_wp, 0.0075_wp, 0.02_wp], -9.81_wp, material(friction, rolling), [.true., .false., .false.])
    call import_state(resumed, state, outcome)
    call expect_all(.not. outcome%failed(), 'a state is taken up')
    call run(whole, 300, dt)
    call run(resumed, 300, dt)
    call expect_all(whole%parcels%n == resumed%parcels%n .and. whole%rebuilds == resumed%rebuilds, &
                    'a resumed run makes the same lists')
    if (whole%parcels%n /= resumed%parcels%n) return
    associate (n => whole%parcels%n)
      call expect_all(all(whole%parcels%id(1:n) == resumed%parcels%id(1:n)), 'it keeps the order of the parcels')
      call expect_all(.not. any(abs(whole%parcels%state(:, 1:n) - resumed%parcels%state(:, 1:n)) > 0), &
                      'and its state is the same, bit for bit')
    end associate
  end subroutine restart

  !> Parcels and their images draw on each other as far as the attraction reaches: the forces of all pairs, in one step.
  subroutine attraction()
    integer, parameter :: n = 60
    real(wp), parameter :: edge = 0.006_wp, reach = 4.0e-4_wp, hamaker = 1.0e-9_wp, nearest = 1.0e-5_wp
    type(solids_t) :: solids
    type(contact_settings_t) :: contact
    real(wp), allocatable :: x(:,:), v(:,:), diameter(:), a(:,:)
    real(wp) :: pull(3), way(3), gap, largest, wrong, dt
    integer :: i, j, pairs

    contact = material(0.0_wp, 'none')
    contact%hamaker_constant = hamaker
    contact%minimum_separation = nearest
    contact%maximum_separation = reach
    call cloud(n, [0.0_wp, 0.0_wp, 0.0_wp], 1.35e-3_wp, [4, 4], x, v, diameter)
    solids = scene(comm, [edge, edge, edge], 0.0_wp, contact, [.true., .true., .true.])
    call put(solids, x, 0*v, diameter)
    dt = 1.0e-9_wp
    call run(solids, 1, dt)
    call gather(solids, n, a)
    largest = 0
    wrong = 0
    pairs = 0
    do i = 1, n
      pull = 0
      do j = 1, n
        if (i == j) cycle
        way = x(:, j) - x(:, i)
        way = way - edge*nint(way/edge)
        gap = norm2(way) - (diameter(i) + diameter(j))/2
        if (gap > reach) cycle
        if (gap > 0) pairs = pairs + 1
        pull = pull + hamaker/6/(2/diameter(i) + 2/diameter(j))/max(gap, nearest)**2*way/norm2(way)
      end do
      largest = max(largest, norm2(pull))
      wrong = max(wrong, norm2(pull - a(5:7, i)/a(8, i)/dt))
    end do
    call expect_all(pairs > 50, 'parcels attract each other from afar')
    call expect_all(wrong < 1.0e-6_wp*largest, 'as all pairs within reach do')
  end subroutine attraction

  !> A drive equal to gravity is gravity, and what the gas does stays with its parcel wherever that goes.
  subroutine driven_by_gas()
    type(solids_t) :: falls, driven
    real(wp), allocatable :: x(:,:), v(:,:), diameter(:), a(:,:), b(:,:)
    logical :: right
    integer :: i

    call falling(comm, 400, 0.3_wp, [.true., .false., .false.], falls)
    call cloud(400, [0.0_wp, 0.0_wp, 0.0_wp], 1.25e-3_wp, [8, 6], x, v, diameter)
    driven = scene(comm, [0.01_wp, 0.0075_wp, 0.02_wp], -9.81_wp, material(0.3_wp), [.true., .false., .false.], &
                   .true.)
    call put(driven, x, v, diameter)
    do i = 1, driven%parcels%n
      driven%parcels%coupled(1:3, i) = [0.0_wp, 0.0_wp, -9.81_wp]
      driven%parcels%coupled(12, i) = real(driven%parcels%id(i), wp)
    end do
    do i = 1, 10
      call run(falls, 25, falls%time_step_limit())
      call run(driven, 25, falls%time_step_limit())
    end do
    call gather(falls, 400, a)
    call gather(driven, 400, b)
    call expect_all(all(abs(a(5:7, :) - b(5:7, :)) < 1.0e-14_wp), 'a drive equal to gravity is gravity')
    associate (p => driven%parcels)
      right = all(nint(p%coupled(12, 1:p%n), i8) == p%id(1:p%n)) .and. &
              all(abs(p%coupled(3, 1:p%n) + 9.81_wp) < 1.0e-12_wp)
    end associate
    call expect_all(right, 'what the gas does stays with its parcel')
  end subroutine driven_by_gas

  !> Parcels that fall through an open floor are counted, not lost.
  subroutine through_open_face()
    type(solids_t) :: solids
    type(statistics_t) :: s
    real(wp) :: x(3, 3), v(3, 3), mass

    solids = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], -9.81_wp, material(0.3_wp))
    solids%chamber%open(1, 3) = .true.
    x(:, 1) = [0.005_wp, 0.005_wp, 0.001_wp]
    x(:, 2) = [0.002_wp, 0.002_wp, 0.002_wp]
    x(:, 3) = [0.005_wp, 0.005_wp, 0.009_wp]
    v = 0
    v(3, :) = -0.5_wp
    call put(solids, x, v, [1.0e-3_wp, 1.0e-3_wp, 1.0e-3_wp])
    s = find_statistics(solids)
    mass = s%mass
    call run(solids, nint(0.006_wp/solids%time_step_limit()), solids%time_step_limit())
    s = find_statistics(solids)
    call expect_all(s%parcels == 1 .and. s%left == 2 .and. s%lost == 0, 'who falls through an open face has left')
    call expect_all(abs(s%mass_left - 2*mass/3) < 1.0e-12_wp*mass .and. abs(s%mass - mass/3) < 1.0e-12_wp*mass, &
                    'and so has its mass')
  end subroutine through_open_face

  !> A parcel shot through a wall and a period too short end the run with a message on all ranks.
  subroutine trouble()
    type(solids_t) :: solids
    type(outcome_t) :: outcome
    real(wp) :: x(3, 1), v(3, 1)

    x(:, 1) = 0.005_wp
    v(:, 1) = [0.0_wp, 0.0_wp, 400.0_wp]
    solids = scene(comm, [0.01_wp, 0.01_wp, 0.01_wp], 0.0_wp, material(0.3_wp))
    call put(solids, x, v, [1.0e-3_wp])
    call solids%advance(1000, solids%time_step_limit(), outcome)
    call expect_all(outcome%failed(), 'a parcel through a wall ends the run')
    if (outcome%failed()) call expect_all(index(outcome%message, 'parcel 1 at') > 0 .and. &
                                          index(outcome%message, 'stiffness') > 0, 'it is named')
    solids = scene(comm, [0.01_wp, 0.002_wp, 0.01_wp], 0.0_wp, material(0.3_wp), [.false., .true., .false.])
    outcome = outcome_t()
    x(2, 1) = 0.001_wp
    call put(solids, x, 0*v, [1.0e-3_wp])
    call solids%advance(1, solids%time_step_limit(), outcome)
    call expect_all(outcome%failed(), 'a period shorter than three ranges ends the run')
  end subroutine trouble

end program test_des_many
