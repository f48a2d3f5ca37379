!> Walls within the domain along which the gas slips, or through which it leaves.
! ranks: 1 2
program test_inner_walls
  use boundary_settings, only: boundary_settings_t
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas, steps
  use kinds, only: wp
  use laminar_flows, only: flow_scene
  use outcome, only: outcome_t
  use pipe_flow, only: pipe, round_scene
  use wall_settings, only: wall_settings_t
  implicit none

  real(wp), parameter :: o = 0.0_wp, edge = 2.0e-3_wp
  type(communicator_t) :: comm
  integer :: a, side

  call start_ranks(comm)
  call slippery_pipe()
  call half_a_channel()
  do a = 1, 3
    do side = -1, 1, 2
      call filter(a, side)
    end do
  end do
  call from_wall_to_wall()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> All walls within the domain.
  function everywhere(scene, kind) result(walls)
    type(scene_t), intent(in) :: scene
    character(len=*), intent(in) :: kind
    type(boundary_settings_t) :: walls

    walls = record('walls', kind, [o, o, o], scene%upper)
    walls%surface = 'walls'
  end function everywhere

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
    scene%records = [everywhere(scene, 'slip')]
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
    scene%records = [everywhere(scene, 'slip')]
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
    real(wp) :: low(3), high(3), worst(3)
    integer :: b, end
    logical :: ok

    scene%cells = 4
    scene%cells(a) = 9
    scene%upper = scene%cells*edge
    call be_exact(scene)
    scene%walls = [plane_across(a, side, (4.5_wp - 2.2_wp*side)*edge)]
    scene%records = [everywhere(scene, 'outflow')]
    scene%records(1)%pressure = behind
    do b = 1, 3
      do end = 1, 2
        low = o
        high = scene%upper
        if (end == 1) high(b) = o
        if (end == 2) low(b) = high(b)
        if (b == a .and. 2*end - 3 /= side) cycle
        if (b == a) scene%records = [scene%records, record('in', 'inflow', low, high, velocity=speed)]
        if (b /= a) scene%records = [scene%records, record('side', 'slip', low, high)]
      end do
    end do
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 4, 2.0e-3_wp)
    associate (n => gas%boxes%n, u => gas%velocity, open => .not. gas%space%closed)
      worst(1) = maxval(abs(u(1:n(1), 1:n(2), 1:n(3), a) + side*speed), gas%space%area(1:n(1), 1:n(2), 1:n(3), a) > o)
      worst(2) = sum(abs(u(1:n(1), 1:n(2), 1:n(3), :))) - sum(abs(u(1:n(1), 1:n(2), 1:n(3), a)))
      worst(3) = maxval(abs(gas%pressure(1:n(1), 1:n(2), 1:n(3)) - behind), open)/(gas%density*speed**2)
    end associate
    worst = comm%max(worst)
    if (comm%is_root()) then
      call expect(ok, 'gas through a filter converges')
      call expect_close(worst(1), o, 1.0e-9_wp, 'its velocity [m/s]')
      call expect_close(worst(2), o, 1.0e-9_wp, 'it is straight [m/s]')
      call expect_close(worst(3), o, 1.0e-8_wp, 'its pressure is the one given, over rho u^2')
      call expect_close(gas%report%inflow/(gas%density*speed*16*edge**2), 1.0_wp, 1.0e-12_wp, 'what comes in')
      call expect_close(gas%report%outflow/gas%report%inflow, 1.0_wp, 1.0e-10_wp, 'leaves through the wall')
    end if
    call gas%destroy()
  end subroutine filter

  subroutine be_exact(scene)
    type(scene_t), intent(inout) :: scene

    scene%numerics%tolerance = 1.0e-12_wp
    scene%numerics%velocity_tolerance = 1.0e-12_wp
    scene%numerics%maximum_iterations = 100
  end subroutine be_exact

  function plane_across(a, side, height) result(wall)
    integer, intent(in) :: a, side
    real(wp), intent(in) :: height  !< [m]
    type(wall_settings_t) :: wall

    wall%kind = 'plane'
    wall%gas_side = 'inside'
    wall%normal = o
    wall%normal(a) = side
    wall%point = height
    wall%rotation_centre = height
  end function plane_across

  !> In through one wall and out through another under the difference of their pressures, against drag alone.
  subroutine from_wall_to_wall()
    real(wp), parameter :: difference = 40.0_wp, drag = 1.0e-3_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: expected, flow, worst
    integer :: b, end
    logical :: ok

    scene%cells = [4, 12, 4]
    scene%upper = scene%cells*edge
    call be_exact(scene)
    scene%walls = [plane_across(2, 1, 1.3_wp*edge), plane_across(2, -1, 9.6_wp*edge)]
    scene%records = [everywhere(scene, 'outflow'), everywhere(scene, 'outflow')]
    scene%records(1)%upper(2) = 5*edge
    scene%records(1)%pressure = difference
    scene%records(2)%lower(2) = 5.5_wp*edge
    do b = 1, 3, 2
      do end = 0, 1
        scene%records = [scene%records, record('side', 'slip', [o, o, o], scene%upper)]
        associate (side => scene%records(size(scene%records)))
          if (end == 0) side%upper(b) = o
          if (end == 1) side%lower(b) = scene%upper(b)
        end associate
      end do
    end do
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
      call expect_close(worst, o, 1.0e-2_wp, 'as fast as drag lets it')
      call expect_close(flow, o, 1.0e-12_wp, 'as much in as out [kg/s]')
    end if
    call gas%destroy()
  end subroutine from_wall_to_wall

end program test_inner_walls
