!> Walls whose surface moves, against closed formulas; a drum on any number of ranks, and resumed.
program test_walls_moving
  use chamber, only: n_faces
  use check, only: expect, expect_all, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use des_scenes, only: put, cloud, run
  use kinds, only: wp
  use mpi_f08, only: MPI_COMM_SELF
  use outcome, only: outcome_t
  use solids, only: solids_t
  use solids_state, only: solids_state_t, export_state, import_state
  use solids_statistics, only: statistics_t, find_statistics
  use wall_motion, only: cross
  use wall_scenes, only: material, room, plane, cylinder, mass_of, column, g, tilt, level
  use wall_settings, only: wall_settings_t
  implicit none

  type(communicator_t) :: comm, alone

  call start_ranks(comm)
  alone%handle = MPI_COMM_SELF
  if (comm%is_root()) then
    call dragged('plane')
    call dragged('cylinder')
    call turntable()
  end if
  call same_on_all_ranks()
  call restart()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> A belt or a drum at speed u sets a ball at rest going with mu g, until it rolls: from t = 2 u/(7 mu g) on at 2/7 u.
  subroutine dragged(kind)
    character(len=*), intent(in) :: kind

    real(wp), parameter :: radius = 0.5e-3_wp, k = 1.0e4_wp, mu = 0.4_wp, u = 0.05_wp, wide = 4.0_wp
    real(wp), parameter :: place(3) = [0.01_wp, 0.01_wp, 0.01_wp]
    type(wall_settings_t) :: wall
    type(solids_t) :: ball
    real(wp) :: speed, spin, start
    integer :: n

    if (kind == 'plane') then
      wall = plane(place + 0.1_wp*level, tilt)
      wall%velocity = u*level
    else
      ! At the bottom, -tilt from the axis, a drum turning about `level` goes along -(level x tilt).
      wall = cylinder(place + wide*tilt + 0.1_wp*level, level, wide)
      wall%angular_velocity = u/wide*level
    end if
    start = 2*u/(7*mu*g)
    ball = room(alone, 0.02_wp, -g*tilt, material(k, 0.5_wp, mu), [wall])
    call put(ball, column(place + (radius - mass_of(2*radius)*g/k)*tilt), column(0*tilt), [2*radius])
    n = nint(start/(0.4_wp*ball%time_step_limit()))
    call run(ball, n/2, start/n)
    call measure(ball, kind, speed, spin)
    call expect_close(speed, mu*g*ball%time, 1.0e-3_wp, 'a '//kind//' that slides by drags a ball with mu g')
    call run(ball, 2*n, start/n)
    call measure(ball, kind, speed, spin)
    call expect_close(speed, 2*u/7, 3.0e-4_wp, 'till it rolls at 2/7 of the speed of the '//kind)
    call expect_close(spin, 5*u/7, 3.0e-4_wp, 'and spins with 5/7')
  end subroutine dragged

  !> Speed of a dragged ball, and of its surface by its spin.
  subroutine measure(ball, kind, speed, spin)
    type(solids_t), intent(in) :: ball
    character(len=*), intent(in) :: kind
    real(wp), intent(out) :: speed, spin  !< [m/s]

    real(wp) :: way(3)

    way = level
    if (kind == 'cylinder') way = -cross(level, tilt)
    speed = dot_product(ball%parcels%state(5:7, 1), way)
    spin = dot_product(cross(ball%parcels%state(9:11, 1), -tilt), way)
  end subroutine measure

  !> A table that turns about a point with Omega and a ball far out: the drag is along Omega x arm, whatever else.
  subroutine turntable()
    real(wp), parameter :: radius = 0.5e-3_wp, k = 1.0e4_wp, mu = 0.4_wp, turn = 0.1_wp, far = 0.5_wp
    real(wp), parameter :: place(3) = [0.01_wp, 0.01_wp, 0.01_wp]
    type(wall_settings_t) :: wall
    type(solids_t) :: ball
    real(wp) :: way(3), v(3), start
    integer :: n

    wall = plane(place + 0.2_wp*level, tilt)
    wall%rotation_centre = place - far*level
    wall%angular_velocity = turn*tilt
    ball = room(alone, 0.02_wp, -g*tilt, material(k, 0.5_wp, mu), [wall])
    call put(ball, column(place + (radius - mass_of(2*radius)*g/k)*tilt), column(0*tilt), [2*radius])
    start = 2*turn*far/(7*mu*g)
    n = nint(start/(0.4_wp*ball%time_step_limit()))
    call run(ball, n/2, start/n)
    way = cross(tilt, level)
    v = ball%parcels%state(5:7, 1)
    call expect_close(dot_product(v, way), mu*g*ball%time, 1.0e-3_wp, 'a turntable drags a ball round')
    call expect(abs(dot_product(v, level)) < 2.0e-2_wp*norm2(v), 'and not outward')
    call run(ball, 2*n, start/n)
    call expect_close(dot_product(ball%parcels%state(5:7, 1), way), 2*turn*far/7, 3.0e-4_wp, 'till it rolls')
  end subroutine turntable

  !> A drum that turns about y with a cloud of parcels in it.
  function drum(ranks) result(solids)
    type(communicator_t), intent(in) :: ranks
    type(solids_t) :: solids

    type(wall_settings_t) :: shell, lid

    shell = cylinder([0.01_wp, 0.01_wp, 0.01_wp], [0.0_wp, 1.0_wp, 0.0_wp], 0.009_wp)
    shell%angular_velocity = [0.0_wp, 12.0_wp, 0.0_wp]
    lid = plane([0.01_wp, 0.002_wp, 0.01_wp], [0.0_wp, 1.0_wp, 0.0_wp])
    lid%angular_velocity = shell%angular_velocity
    solids = room(ranks, 0.02_wp, [0.0_wp, 0.0_wp, -g], material(100.0_wp, 0.6_wp, 0.4_wp), [lid, shell])
  end function drum

  subroutine fill(solids)
    type(solids_t), intent(inout) :: solids

    real(wp), allocatable :: x(:,:), v(:,:), diameter(:)

    call cloud(200, [0.0045_wp, 0.0035_wp, 0.004_wp], 1.25e-3_wp, [8, 5], x, v, diameter)
    call put(solids, x, v, diameter)
  end subroutine fill

  !> Position, velocity and spin of all parcels by id, on all ranks.
  subroutine gather(solids, n, every)
    type(solids_t), intent(in) :: solids
    integer, intent(in) :: n
    real(wp), intent(out) :: every(9, n)

    integer :: i

    every = 0.0_wp
    do i = 1, solids%parcels%n
      associate (s => solids%parcels%state(:, i))
        every(:, solids%parcels%id(i)) = [s(1:3), s(5:7), s(9:11)]
      end associate
    end do
    do i = 1, 9
      every(i, :) = solids%comm%sum(every(i, :))
    end do
  end subroutine gather

  !> All ranks together and each by itself compute the same drum, which turns its parcels and loses none.
  subroutine same_on_all_ranks()
    type(solids_t) :: together, apart
    type(statistics_t) :: s
    real(wp) :: a(9, 200), b(9, 200), dt
    integer :: i

    together = drum(comm)
    apart = drum(alone)
    call fill(together)
    call fill(apart)
    dt = apart%time_step_limit()
    do i = 1, 10
      call run(together, 30, dt)
      call run(apart, 30, dt)
    end do
    call gather(together, 200, a)
    call gather(apart, 200, b)
    call expect_all(together%tilings > 1 .or. comm%size == 1, 'tiles change hands in a drum')
    call expect_all(all(abs(a(1:3, :) - b(1:3, :)) < 1.0e-10_wp*0.01_wp), 'positions in a drum do not depend on the ranks')
    call expect_all(all(abs(a(4:9, :) - b(4:9, :)) < 1.0e-10_wp*0.5_wp), 'nor velocities and spins')
    call run(together, 20000, dt)
    s = find_statistics(together)
    call gather(together, 200, a)
    call expect_all(s%lost == 0 .and. s%parcels == 200 .and. s%wall_contacts > 50 .and. s%max_overlap < 0.1_wp, &
                    'a drum loses no parcel')
    ! It turns about y: its bottom goes to lower x and takes the heap along.
    call expect_all(sum(a(1, :))/200 < 0.0085_wp, 'and carries them up its side')
  end subroutine same_on_all_ranks

  !> A drum taken up from its exported state goes on bit for bit.
  subroutine restart()
    type(solids_t) :: whole, resumed
    type(solids_state_t) :: state
    type(outcome_t) :: outcome
    real(wp) :: dt

    whole = drum(comm)
    call fill(whole)
    dt = whole%time_step_limit()
    call run(whole, 2017, dt)
    call export_state(whole, state)
    resumed = drum(comm)
    call import_state(resumed, state, outcome)
    call expect_all(.not. outcome%failed(), 'the state of a drum is taken up')
    call expect_all(comm%any_of(any(state%partner < -n_faces)), 'with slips along its walls')
    call run(whole, 300, dt)
    call run(resumed, 300, dt)
    call expect_all(whole%parcels%n == resumed%parcels%n, 'a resumed drum has the parcels where they were')
    if (whole%parcels%n /= resumed%parcels%n) return
    associate (n => whole%parcels%n)
      call expect_all(all(whole%parcels%id(1:n) == resumed%parcels%id(1:n)), 'it keeps their order')
      call expect_all(.not. any(abs(whole%parcels%state(:, 1:n) - resumed%parcels%state(:, 1:n)) > 0), &
                      'and turns on bit for bit')
    end associate
  end subroutine restart

end program test_walls_moving
