!> Meshes that move: belts, pistons and drums against closed formulas; a drum with blades on any number of ranks, and resumed.
program test_mesh_moving
  use chamber, only: n_faces
  use check, only: expect, expect_all, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use des_scenes, only: put, cloud, run
  use kinds, only: wp
  use mesh_checks, only: find_reach
  use mesh_scenes, only: mesh_room, mesh, sheet, ball, drum
  use mpi_f08, only: MPI_COMM_SELF
  use outcome, only: outcome_t
  use solids, only: solids_t
  use solids_state, only: solids_state_t, export_state, import_state
  use solids_statistics, only: statistics_t, find_statistics
  use surface, only: surface_t, new_surface
  use wall_motion, only: wall_motion_t, cross
  use wall_scenes, only: material, mass_of, column, g, tilt, level
  use wall_settings, only: wall_settings_t
  implicit none

  type(communicator_t) :: comm, alone

  call start_ranks(comm)
  alone%handle = MPI_COMM_SELF
  if (comm%is_root()) then
    call reach_of_a_turn()
    call dragged(stays=.true.)
    call dragged(stays=.false.)
    call turntable()
    call piston()
    call sweeper()
    call cylinder()
    call swing()
  end if
  call same_on_all_ranks()
  call restart()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> A point that turns about z by a third and runs along z.
  subroutine reach_of_a_turn()
    type(wall_motion_t) :: motion
    real(wp) :: lower(3), upper(3)

    motion = wall_motion_t([0.0_wp, 0.0_wp, -2.0_wp], [0.0_wp, 0.0_wp, pi], [1.0_wp, 1.0_wp, 0.0_wp])
    call find_reach(motion, [1.5_wp, 1 + 0.5_wp*sqrt(3.0_wp), 0.0_wp], 2.0_wp/3, lower, upper)
    call expect(norm2(lower - [0.0_wp, 1.0_wp, -4.0_wp/3]) < 1.0e-12_wp .and. &
                norm2(upper - [1.5_wp, 2.0_wp, 0.0_wp]) < 1.0e-12_wp, 'a point that turns stays in its box')
    call find_reach(motion, [1.0_wp, 0.5_wp, 0.0_wp], 5.0_wp, lower, upper)
    call expect(norm2(lower(1:2) - 0.5_wp) < 1.0e-12_wp .and. norm2(upper(1:2) - 1.5_wp) < 1.0e-12_wp, &
                'all around, in that of a circle')
  end subroutine reach_of_a_turn

  !> A belt at speed u sets a ball at rest going with mu g, until it rolls: from t = 2 u/(7 mu g) on at 2/7 u. So does a sheet that
  !> runs along itself, however its triangles pass below.
  subroutine dragged(stays)
    logical, intent(in) :: stays

    real(wp), parameter :: radius = 0.5e-3_wp, k = 1.0e4_wp, mu = 0.4_wp, u = 0.05_wp
    real(wp), parameter :: place(3) = [0.02_wp, 0.02_wp, 0.02_wp]
    type(wall_settings_t) :: wall
    type(solids_t) :: lump
    real(wp) :: start, a(3), b(3)
    character(len=:), allocatable :: name
    integer :: n

    name = trim(merge('belt ', 'sheet', stays))
    wall = mesh()
    wall%stays = stays
    wall%velocity = u*level
    a = 0.02_wp*level
    b = 0.01_wp*cross(tilt, level)
    start = 2*u/(7*mu*g)
    lump = mesh_room(alone, 0.04_wp, -g*tilt, material(k, 0.5_wp, mu), [wall], &
                     [new_surface(sheet(place - 0.51_wp*a - 0.47_wp*b, a, b, [60, 30], 0.5_wp))])
    call put(lump, column(place + (radius - mass_of(2*radius)*g/k)*tilt), column(0*tilt), [2*radius])
    n = nint(start/(0.4_wp*lump%time_step_limit()))
    call run(lump, n/2, start/n)
    call expect_close(dot_product(lump%parcels%state(5:7, 1), level), mu*g*lump%time, 1.0e-3_wp, &
                      'a '//name//' drags a ball with mu g')
    call run(lump, 2*n, start/n)
    call expect_close(dot_product(lump%parcels%state(5:7, 1), level), 2*u/7, 3.0e-4_wp, 'till it rolls at 2/7 of the speed')
    call expect_close(dot_product(cross(lump%parcels%state(9:11, 1), -tilt), level), 5*u/7, 3.0e-4_wp, 'and spins with 5/7')
    call expect(abs(dot_product(lump%parcels%state(1:3, 1) - place, tilt) - radius) < 1.0e-6_wp, 'and stays on the '//name)
  end subroutine dragged

  !> A sheet that turns about a point far out with Omega.
  subroutine turntable()
    real(wp), parameter :: radius = 0.5e-3_wp, k = 1.0e4_wp, mu = 0.4_wp, turn = 0.1_wp, far = 0.5_wp
    real(wp), parameter :: place(3) = [0.02_wp, 0.02_wp, 0.02_wp]
    type(wall_settings_t) :: wall
    type(solids_t) :: lump
    real(wp) :: way(3), a(3), b(3), start
    integer :: n

    wall = mesh()
    wall%rotation_centre = place - far*level
    wall%angular_velocity = turn*tilt
    way = cross(tilt, level)
    a = 0.01_wp*level
    b = 0.01_wp*way
    lump = mesh_room(alone, 0.04_wp, -g*tilt, material(k, 0.5_wp, mu), [wall], &
                     [new_surface(sheet(place - 0.51_wp*a - 0.47_wp*b, a, b, [30, 30], 0.5_wp))])
    call put(lump, column(place + (radius - mass_of(2*radius)*g/k)*tilt), column(0*tilt), [2*radius])
    start = 2*turn*far/(7*mu*g)
    n = nint(start/(0.4_wp*lump%time_step_limit()))
    call run(lump, n/2, start/n)
    call expect_close(dot_product(lump%parcels%state(5:7, 1), way), mu*g*lump%time, 1.0e-3_wp, 'a turntable drags a ball round')
    call run(lump, 2*n, start/n)
    call expect_close(dot_product(lump%parcels%state(5:7, 1), way), 2*turn*far/7, 3.0e-4_wp, 'till it rolls')
  end subroutine turntable

  !> A piston at speed u throws a ball at rest off with (1 + e) u.
  subroutine piston()
    real(wp), parameter :: radius = 0.5e-3_wp, e = 0.6_wp, u = 0.1_wp
    real(wp), parameter :: place(3) = [0.02_wp, 0.02_wp, 0.02_wp]
    type(wall_settings_t) :: wall
    type(solids_t) :: lump
    real(wp) :: a(3), b(3), t

    wall = mesh()
    wall%velocity = u*tilt
    a = 0.01_wp*level
    b = 0.01_wp*cross(tilt, level)
    lump = mesh_room(alone, 0.04_wp, 0*tilt, material(1.0e4_wp, e, 0.0_wp), [wall], &
                     [new_surface(sheet(place - 0.51_wp*a - 0.47_wp*b, a, b, [4, 5], 0.5_wp))])
    call put(lump, column(place + 4*radius*tilt), column(0*tilt), [2*radius])
    t = 1.5_wp*4*radius/u
    call run(lump, ceiling(t/lump%time_step_limit()), t/ceiling(t/lump%time_step_limit()))
    call expect(norm2(lump%parcels%state(5:7, 1) - (1 + e)*u*tilt) < 1.0e-3_wp*u, 'a piston throws a ball off with (1 + e) u')
    call expect_close(dot_product(lump%parcels%state(1:3, 1) - place, tilt), 4*radius + (1 + e)*u*(t - 3*radius/u), 1.0e-3_wp, &
                      'at the time it reaches it')
  end subroutine piston

  !> A blade that turns with Omega hits a ball at a distance R from its axis with Omega R.
  subroutine sweeper()
    real(wp), parameter :: radius = 0.5e-3_wp, e = 0.8_wp, omega = 20.0_wp, arm = 8.0e-3_wp
    real(wp), parameter :: place(3) = [0.02_wp, 0.02_wp, 0.02_wp]
    type(wall_settings_t) :: wall
    type(solids_t) :: lump
    real(wp) :: way(3), out(3), angle, t
    integer :: steps

    wall = mesh()
    wall%angular_velocity = omega*tilt
    wall%rotation_centre = place
    lump = mesh_room(alone, 0.04_wp, 0*tilt, material(1.0e4_wp, e, 0.0_wp), [wall], &
                     [new_surface(sheet(place - 0.004_wp*tilt, 0.012_wp*level, 0.008_wp*tilt, [4, 5], 0.0_wp))])
    angle = 1.0_wp
    out = cos(angle)*level + sin(angle)*cross(tilt, level)
    way = cross(tilt, out)
    call put(lump, column(place + arm*out + 2*radius*way), column(0*tilt), [2*radius])
    ! The blade is at the ball when r is the distance of the ball from the axis times the sine of the angle left.
    t = (angle + atan2(2*radius, arm) - asin(radius/sqrt(arm**2 + 4*radius**2)))/omega
    steps = ceiling(1.1_wp*t/lump%time_step_limit())
    call run(lump, steps, 1.1_wp*t/steps)
    angle = omega*t
    out = cos(angle)*level + sin(angle)*cross(tilt, level)
    way = cross(tilt, out)
    call expect(norm2(lump%parcels%state(5:7, 1) - (1 + e)*omega*sqrt(arm**2 + 3*radius**2)*way) &
                < 5.0e-3_wp*omega*arm, 'a blade throws a ball off along its normal')
  end subroutine sweeper

  !> In a drum of many facets that turns, a ball that rolls on the spot has the surface speed of the drum's radius.
  subroutine cylinder()
    real(wp), parameter :: radius = 1.0e-3_wp, wide = 0.01_wp, omega = 5.0_wp, up(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    real(wp), parameter :: centre(3) = [0.02_wp, 0.02_wp, 0.02_wp], axis(3) = [0.6_wp, 0.8_wp, 0.0_wp]
    type(wall_settings_t) :: wall
    type(solids_t) :: lump
    type(statistics_t) :: s
    real(wp) :: out(3)

    wall = mesh()
    wall%angular_velocity = omega*axis
    wall%rotation_centre = centre
    out = cross(axis, up)
    lump = mesh_room(alone, 0.04_wp, -g*up, material(1.0e4_wp, 0.5_wp, 0.5_wp), [wall], &
                     [new_surface(drum(centre - 0.005_wp*axis, 0.01_wp*axis, wide, 300, 0, 0.0_wp))])
    call put(lump, column(centre - (wide - radius)*up), column(0*up), [2*radius])
    lump%parcels%state(9:11, 1) = omega*wide*axis
    call run(lump, 20000, lump%time_step_limit())
    s = find_statistics(lump)
    associate (x => lump%parcels%state(1:3, 1), v => lump%parcels%state(5:7, 1), spin => lump%parcels%state(9:11, 1))
      call expect(s%parcels == 1 .and. norm2(v) < 0.03_wp*omega*wide .and. abs(dot_product(x - centre, out)) < 0.1_wp*radius, &
                  'a ball stays at the bottom of a turning drum')
      call expect_close(dot_product(spin, axis), omega*wide, 2.0e-2_wp, 'and rolls with its surface')
    end associate
  end subroutine cylinder

  !> In a pipe of many facets a ball rolls to and fro with the period 2 pi sqrt(7 (R - r)/(5 g)) (1 + angle^2/16) of a pipe: its
  !> slip goes with it from facet to facet.
  subroutine swing()
    real(wp), parameter :: wide = 0.05_wp, radius = 0.005_wp, angle = 0.3_wp, k = 1.0e5_wp
    real(wp), parameter :: centre(3) = [0.1_wp, 0.1_wp, 0.1_wp], along(3) = [0.6_wp, 0.8_wp, 0.0_wp]
    real(wp), parameter :: aside(3) = [0.8_wp, -0.6_wp, 0.0_wp], up(3) = [0.0_wp, 0.0_wp, 1.0_wp]
    type(solids_t) :: lump
    real(wp) :: sag, passed(2), before, now, dt
    integer :: n

    lump = mesh_room(alone, 0.2_wp, -g*up, material(k, 0.5_wp, 0.5_wp), [mesh()], &
                     [new_surface(drum(centre - 0.02_wp*along, 0.04_wp*along, wide, 1500, 0, 0.0_wp))])
    sag = mass_of(2*radius)*g/k
    call put(lump, column(centre + (wide - radius + sag)*(sin(angle)*aside - cos(angle)*up)), column(0*up), [2*radius])
    dt = lump%time_step_limit()
    n = 0
    before = 1.0_wp
    do while (n < 2)
      call run(lump, 1, dt)
      now = dot_product(lump%parcels%state(1:3, 1) - centre, aside)
      if (now <= 0.0_wp .and. before > 0.0_wp) then
        n = n + 1
        passed(n) = lump%time + dt*now/(before - now)
      end if
      before = now
    end do
    call expect_close(passed(2) - passed(1), 2*pi*sqrt(1.4_wp*(wide - radius)/g)*(1 + angle**2/16), 2.0e-4_wp, &
                      'a ball rolls in a pipe of facets with its period')
    call expect(abs(dot_product(lump%parcels%state(1:3, 1) - centre, along)) < 1.0e-5_wp, 'and stays where it is along it')
  end subroutine swing

  !> A drum with four blades that turns about y with a cloud of parcels in it.
  function mill(ranks) result(solids)
    type(communicator_t), intent(in) :: ranks
    type(solids_t) :: solids

    real(wp), parameter :: centre(3) = [0.01_wp, 0.01_wp, 0.01_wp], axis(3) = [0.0_wp, 0.016_wp, 0.0_wp]
    type(wall_settings_t) :: wall

    wall = mesh()
    wall%angular_velocity = [0.0_wp, 25.0_wp, 0.0_wp]
    wall%rotation_centre = centre
    wall%open = .true.
    solids = mesh_room(ranks, 0.02_wp, [0.0_wp, 0.0_wp, -g], material(100.0_wp, 0.6_wp, 0.4_wp), [wall], &
                       [new_surface(drum(centre - 0.5_wp*axis, axis, 0.009_wp, 32, 4, 0.002_wp))])
  end function mill

  subroutine fill(solids)
    type(solids_t), intent(inout) :: solids

    real(wp), allocatable :: x(:,:), v(:,:), diameter(:)

    call cloud(200, [0.0055_wp, 0.0035_wp, 0.005_wp], 1.25e-3_wp, [7, 9], x, v, diameter)
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

  !> All ranks together and each by itself compute the same mill, which turns its parcels and loses none.
  subroutine same_on_all_ranks()
    type(solids_t) :: together, apart
    type(statistics_t) :: s
    real(wp) :: a(9, 200), b(9, 200), dt
    integer :: i

    together = mill(comm)
    apart = mill(alone)
    call fill(together)
    call fill(apart)
    dt = apart%time_step_limit()
    do i = 1, 10
      call run(together, 30, dt)
      call run(apart, 30, dt)
    end do
    call gather(together, 200, a)
    call gather(apart, 200, b)
    call expect_all(all(abs(a(1:3, :) - b(1:3, :)) < 1.0e-10_wp*0.01_wp), 'positions in a mill do not depend on the ranks')
    call expect_all(all(abs(a(4:9, :) - b(4:9, :)) < 1.0e-10_wp*0.5_wp), 'nor velocities and spins')
    call run(together, 6000, dt)
    s = find_statistics(together)
    call gather(together, 200, a)
    call expect_all(s%lost == 0 .and. s%parcels == 200 .and. s%wall_contacts > 50 .and. s%max_overlap < 0.1_wp, &
                    'a mill loses no parcel')
    call expect_all(all((a(1, :) - 0.01_wp)**2 + (a(3, :) - 0.01_wp)**2 < 0.009_wp**2), 'and keeps them in')
    call expect_all(sum(a(1, :))/200 < 0.0085_wp, 'and carries them up its side')
  end subroutine same_on_all_ranks

  !> A mill taken up from its exported state goes on bit for bit.
  subroutine restart()
    type(solids_t) :: whole, resumed
    type(solids_state_t) :: state
    type(outcome_t) :: outcome
    real(wp) :: dt

    whole = mill(comm)
    call fill(whole)
    dt = whole%time_step_limit()
    call run(whole, 2017, dt)
    call export_state(whole, state)
    resumed = mill(comm)
    call import_state(resumed, state, outcome)
    call expect_all(.not. outcome%failed(), 'the state of a mill is taken up')
    call expect_all(comm%any_of(any(state%partner < -n_faces)), 'with slips along its triangles')
    call run(whole, 300, dt)
    call run(resumed, 300, dt)
    call expect_all(whole%parcels%n == resumed%parcels%n, 'a resumed mill has the parcels where they were')
    if (whole%parcels%n /= resumed%parcels%n) return
    associate (n => whole%parcels%n)
      call expect_all(all(whole%parcels%id(1:n) == resumed%parcels%id(1:n)), 'it keeps their order')
      call expect_all(.not. any(abs(whole%parcels%state(:, 1:n) - resumed%parcels%state(:, 1:n)) > 0), &
                      'and turns on bit for bit')
    end associate
  end subroutine restart

end program test_mesh_moving
