!> Walls within the domain along which the gas slips, or through which it leaves.
! ranks: 1 2
program test_inner_walls
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use gas, only: gas_t
  use gas_cases, only: scene_t, make_gas, steps
  use gas_settings, only: compressibility
  use kinds, only: wp
  use laminar_flows, only: flow_scene
  use outcome, only: outcome_t
  use pipe_flow, only: pipe, round_scene
  use plug_flow, only: edge, walls_record, plane_across, plug_scene, slip_sides, plug_errors
  implicit none

  real(wp), parameter :: o = 0.0_wp
  type(communicator_t) :: comm
  integer :: a, side

  call start_ranks(comm)
  call slippery_pipe()
  call pipe_that_slips_in_part()
  call half_a_channel()
  do a = 1, 3
    do side = -1, 1, 2
      call filter(a, side)
    end do
  end do
  call from_wall_to_wall()
  call column()
  call two_filters()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Nothing holds a gas in a pipe along whose wall it slips: under a pressure drop it runs ever faster.
  subroutine slippery_pipe()
    real(wp), parameter :: drop = 3.0e-3_wp, dt = 0.1_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: axis(3), worst, expected
    logical :: ok

    call round_scene(8, 0.01_wp, scene, axis)
    scene%settings%pressure_drop = [o, drop, o]
    scene%walls = [pipe(axis, 2, 0.01_wp)]
    scene%records = [walls_record(scene, 'slip')]
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 5, dt)
    expected = 5*dt*drop/(scene%upper(2)*gas%density)
    associate (n => gas%boxes%n)
      worst = maxval(abs(gas%velocity(1:n(1), 1:n(2), 1:n(3), 2) - expected*gas%free(1:n(1), 1:n(2), 1:n(3), 2)))
    end associate
    worst = comm%max(worst)
    if (comm%is_root()) then
      call expect(ok, 'gas that slips along a pipe converges')
      call expect_close(worst/expected, o, 0.02_wp, 'and is not held by it, where it would be at 0.02 of that speed')
    end if
    call gas%destroy()
  end subroutine slippery_pipe

  !> The last third of a pipe does not hold the gas: a flow between a cell that does and one that does not is held half as much.
  subroutine pipe_that_slips_in_part()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: axis(3), held, wrong

    call round_scene(8, 0.01_wp, scene, axis)
    scene%walls = [pipe(axis, 2, 0.01_wp)]
    scene%records = [walls_record(scene, 'slip')]
    scene%records(1)%lower(2) = scene%upper(2)/1.5_wp
    call make_gas(comm, scene, gas, outcome)
    associate (n => gas%boxes%n, near => gas%space%nearness)
      held = comm%max(maxval(near(1:n(1), 1, 1:n(3), 2)))
      wrong = comm%max(maxval(abs(near(1:n(1), 2, 1:n(3), 2) - 0.5_wp*near(1:n(1), 1, 1:n(3), 2)), &
                              gas%space%wall(1:n(1), 2, 1:n(3)) > o))
    end associate
    if (comm%is_root()) then
      call expect(held > 0.0_wp, 'where all of a pipe holds the gas it is near the wall')
      call expect_close(wrong/held, o, 1.0e-12_wp, 'and half as near where half of it does')
    end if
    call gas%destroy()
  end subroutine pipe_that_slips_in_part

  !> Between a plane on which the gas sticks and one along which it slips, neither in line with the grid: half a parabola.
  subroutine half_a_channel()
    real(wp) :: error(2)
    integer :: m

    do m = 1, 2
      call channel(8*m, error(m))
    end do
    if (.not. comm%is_root()) return
    call expect_close(error(2), o, 0.01_wp, 'flow between a wall that holds and one that does not')
    call expect(abs(error(2)) < 0.5_wp*abs(error(1)), 'nearer on the finer grid')
  end subroutine half_a_channel

  !> The error of the flow over G H^3/(3 mu), n cells across.
  subroutine channel(n, error)
    integer, intent(in) :: n
    real(wp), intent(out) :: error

    real(wp), parameter :: drop = 3.0_wp, width = 0.01_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: h, flow
    logical :: ok

    h = width/n
    scene = flow_scene([n + 2, 3, 3]*h, [n + 2, 3, 3], [.false., .true., .true.])
    scene%settings%pressure_drop = [o, drop, o]
    scene%walls = [plane_across(1, 1, 0.8_wp*h), plane_across(1, -1, width + 0.8_wp*h)]
    scene%records = [walls_record(scene, 'slip')]
    scene%records(1)%lower(1) = 0.5_wp*scene%upper(1)
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 4, 10.0_wp)
    associate (m => gas%boxes%n)
      flow = comm%sum(sum(gas%flux(1:m(1), 1:m(2), 1:m(3), 2)))/(3*gas%density)
    end associate
    error = flow/(drop/(3*h)*width**3/(3*gas%viscosity)*3*h) - 1
    if (comm%is_root()) call expect(ok, 'half a channel converges')
    call gas%destroy()
  end subroutine channel

  !> What comes in through a face leaves through a plane across a that cuts cells, at the pressure given there.
  subroutine filter(a, side)
    integer, intent(in) :: a
    integer, intent(in) :: side  !< 1: the gas is above the plane, -1: below

    real(wp), parameter :: speed = 0.6_wp, behind = 250.0_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: worst(3), swirl
    logical :: ok

    scene = plug_scene(a, 9)
    scene%settings%turbulence_model = 'smagorinsky'
    scene%settings%smagorinsky_constant = 1.0_wp
    scene%walls = [plane_across(a, side, (4.5_wp - 2.2_wp*side)*edge)]
    scene%records = [walls_record(scene, 'outflow')]
    scene%records(1)%pressure = behind
    call slip_sides(scene, a, side, 'inflow')
    where (scene%records%kind == 'inflow') scene%records%velocity = speed
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 4, 2.0e-3_wp)
    worst = plug_errors(comm, gas, a, -side*speed, behind)
    swirl = comm%max(maxval(gas%eddies%viscosity))
    if (comm%is_root()) then
      call expect(ok, 'gas through a filter converges')
      call expect_close(worst(1), o, 1.0e-9_wp, 'its velocity [m/s]')
      call expect_close(worst(2), o, 1.0e-9_wp, 'it is straight [m/s]')
      call expect_close(worst(3), o, 1.0e-8_wp, 'its pressure is the one given, over rho u^2')
      call expect_close(swirl/gas%viscosity, o, 1.0e-6_wp, 'no eddies, over the viscosity')
      call expect_close(gas%report%inflow/(gas%density*speed*16*edge**2), 1.0_wp, 1.0e-12_wp, 'what comes in')
      call expect_close(gas%report%outflow/gas%report%inflow, 1.0_wp, 1.0e-10_wp, 'leaves through the wall')
    end if
    call gas%destroy()
  end subroutine filter

  !> In through one wall and out through another under the difference of their pressures, against drag alone.
  subroutine from_wall_to_wall()
    real(wp), parameter :: difference = 40.0_wp, drag = 1.0e-3_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: expected, flow, worst
    logical :: ok

    scene = plug_scene(2, 12)
    scene%walls = [plane_across(2, 1, 1.3_wp*edge), plane_across(2, -1, 9.6_wp*edge)]
    scene%records = [walls_record(scene, 'outflow'), walls_record(scene, 'outflow')]
    scene%records(1)%upper(2) = 5*edge
    scene%records(1)%pressure = difference
    scene%records(2)%lower(2) = 5.5_wp*edge
    call slip_sides(scene, 2, 0, '')
    call make_gas(comm, scene, gas, outcome)
    gas%drag = drag
    ok = steps(gas, 20, 1.0_wp)
    ! the drag of the second to the tenth cell
    expected = difference*edge**2/(9*drag)
    associate (n => gas%boxes%n, u => gas%velocity)
      worst = maxval(abs(u(1:n(1), 1:n(2), 1:n(3), 2) - expected), gas%space%area(1:n(1), 1:n(2), 1:n(3), 2) > o)/expected
    end associate
    worst = comm%max(worst)
    flow = gas%report%outflow
    if (comm%is_root()) then
      call expect(ok, 'gas from wall to wall converges')
      call expect_close(worst, o, 1.0e-3_wp, 'as fast as drag lets it')
      call expect_close(flow, o, 1.0e-12_wp, 'as much in as out [kg/s]')
    end if
    call gas%destroy()
  end subroutine from_wall_to_wall

  !> An ideal gas at rest on a filter, whose pressure carries its weight: nothing moves.
  subroutine column()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: fastest, least
    logical :: ok

    scene = heavy_scene()
    scene%walls = [plane_across(2, 1, 1.3_wp*edge)]
    scene%records = [walls_record(scene, 'outflow')]
    call slip_sides(scene, 2, 0, '')
    call make_gas(comm, scene, gas, outcome)
    call gas%balance()
    associate (n => gas%boxes%n)
      least = comm%min(minval(gas%pressure(1:n(1), 1:n(2), 1:n(3)), .not. gas%space%closed))
      ok = steps(gas, 5, 1.0e-3_wp)
      fastest = comm%max(maxval(abs(gas%velocity(1:n(1), 1:n(2), 1:n(3), :))))
    end associate
    if (comm%is_root()) then
      call expect(ok, 'an ideal gas on a filter converges')
      call expect_close(fastest, o, 1.0e-7_wp, 'and rests [m/s]')
      call expect_close(least/(-gas%density*9.81_wp*10*edge), 1.0_wp, 1.0e-3_wp, 'its pressure falls by its weight')
    end if
    call gas%destroy()
  end subroutine column

  !> Filters at two heights: each has the pressure given from the start.
  subroutine two_filters()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: worst

    scene = heavy_scene()
    scene%walls = [plane_across(2, 1, 1.3_wp*edge), plane_across(2, -1, 9.6_wp*edge)]
    scene%records = [walls_record(scene, 'outflow')]
    scene%records(1)%pressure = 7.0_wp
    call make_gas(comm, scene, gas, outcome)
    call gas%balance()
    associate (n => gas%boxes%n)
      worst = comm%max(maxval(abs(gas%pressure(1:n(1), 1:n(2), 1:n(3)) - 7), gas%boundary%walls%vents(1:n(1), 1:n(2), 1:n(3))))
    end associate
    if (comm%is_root()) call expect_close(worst, o, 1.0e-9_wp, 'filters at two heights [Pa]')
    call gas%destroy()
  end subroutine two_filters

  !> Of an ideal gas under gravity.
  function heavy_scene() result(scene)
    type(scene_t) :: scene

    scene = plug_scene(2, 12)
    scene%settings%density_law = 'ideal'
    scene%settings%molar_mass = 0.029_wp
    scene%settings%temperature = 290.0_wp
    scene%settings%reference_pressure = 1.0e5_wp
    scene%settings%density = compressibility(scene%settings)*1.0e5_wp
    scene%gravity = [o, -9.81_wp, o]
  end function heavy_scene

end program test_inner_walls
