!> Walls within the domain along which the gas slips, that move, or through which it leaves.
! ranks: 1 2
program test_inner_walls
  use boundary_settings, only: boundary_settings_t
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas, set_cells, steps
  use kinds, only: wp
  use laminar_flows, only: flow_scene
  use mesh_scenes, only: mesh, tube
  use outcome, only: outcome_t
  use pipe_flow, only: pipe
  use surface, only: new_surface
  use wall_settings, only: wall_settings_t
  implicit none

  real(wp), parameter :: o = 0.0_wp, edge = 2.0e-3_wp
  real(wp), parameter :: outer = 0.01_wp, inner = 0.004_wp, spin = 0.5_wp  !< of two cylinders [m], [rad/s]
  type(communicator_t) :: comm
  integer :: a, side

  call start_ranks(comm)
  do a = 1, 3
    call belt(a, 'none')
    call belt(a, 'smagorinsky')
  end do
  call drums()
  call between_cylinders()
  call running_pipe()
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

  !> A plane across a that cuts cells and runs along itself; a plate at rest at the other end: a straight line, whose shear is the
  !> same everywhere, and so is the viscosity of eddies.
  subroutine belt(a, turbulence)
    integer, intent(in) :: a
    character(len=*), intent(in) :: turbulence

    real(wp), parameter :: speed = 0.3_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: height, worst, x(3)
    integer :: i, j, k, along
    logical :: ok

    along = modulo(a, 3) + 1
    scene%cells = 3
    scene%cells(a) = 8
    scene = flow_scene(scene%cells*edge, scene%cells, [.true., .true., .true.])
    scene%periodic(a) = .false.
    scene%settings%pressure_drop = o
    allocate (scene%records(0), scene%walls(1))
    scene%settings%turbulence_model = turbulence
    scene%settings%smagorinsky_constant = 2.0_wp  ! a third of the viscosity
    height = 1.3_wp*edge
    scene%walls(1)%kind = 'plane'
    scene%walls(1)%gas_side = 'inside'
    scene%walls(1)%point = height
    scene%walls(1)%rotation_centre = height
    scene%walls(1)%normal = o
    scene%walls(1)%normal(a) = 1.0_wp
    scene%walls(1)%velocity = o
    scene%walls(1)%velocity(along) = speed
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, merge(15, 4, turbulence == 'smagorinsky'), 10.0_wp)
    worst = o
    do k = 1, gas%boxes%n(3)
      do j = 1, gas%boxes%n(2)
        do i = 1, gas%boxes%n(1)
          if (.not. gas%free(i, j, k, along) > o) cycle
          x = gas%mesh%in_metres(gas%boxes%lo + [i, j, k] - 1.5_wp)
          if (gas%space%area(i, j, k, along) < 1.0_wp) x(a) = 0.5_wp*(height + 2*edge)
          worst = max(worst, abs(gas%velocity(i, j, k, along) - speed*(scene%upper(a) - x(a))/(scene%upper(a) - height)))
        end do
      end do
    end do
    worst = comm%max(worst)
    if (comm%is_root()) then
      call expect(ok, 'gas above a belt converges')
      call expect_close(worst/speed, o, 1.0e-6_wp, 'and is between belt and plate on a straight line')
    end if
    call gas%destroy()
  end subroutine belt

  !> A drum full of gas turns it as a whole, whether it is a cylinder or made of triangles.
  subroutine drums()
    real(wp) :: error(3), fall, other
    integer :: m

    do m = 1, 2
      call drum(16*m - 8, .false., error(m), fall)
    end do
    call drum(24, .true., error(3), other)
    if (.not. comm%is_root()) return
    call expect_close(error(2), o, 0.02_wp, 'gas in a drum turns with it')
    call expect(error(2) < 0.5_wp*error(1), 'nearer on the finer grid')
    call expect_close(fall, 1.0_wp, 0.03_wp, 'its pressure over rho (omega r)^2/2')
    call expect_close(error(3)/error(2), 1.0_wp, 0.1_wp, 'and in one of triangles whose surface runs')
    call expect_close(other/fall, 1.0_wp, 0.02_wp, 'as does the pressure')
  end subroutine drums

  subroutine drum(n, triangles, error, fall)
    integer, intent(in) :: n
    logical, intent(in) :: triangles
    real(wp), intent(out) :: error  !< root of the mean square of velocities, over the speed of the wall
    real(wp), intent(out) :: fall   !< difference of the pressures near wall and axis, over what it should be

    real(wp), parameter :: radius = 0.01_wp, fast = 30.0_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: h, axis(3), start(3), x(3), r, sums(4), squares(2)
    integer :: i, k
    logical :: ok

    call round_scene(n, radius, scene, axis)
    h = 2*radius/n
    scene%walls = [pipe(axis, 2, radius)]
    if (triangles) then
      scene%walls(1) = mesh()
      scene%walls(1)%gas_side = 'inside'
      scene%walls(1)%stays = .true.
      scene%walls(1)%rotation_centre = axis
      start = [axis(1), -h, axis(3)]
      scene%surfaces = [new_surface(tube(start, [o, 5*h, o], [radius, radius], 200))]
    end if
    scene%walls(1)%angular_velocity = [o, fast, o]
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 20, 0.01_wp)
    sums = o
    squares = o
    do k = 1, gas%boxes%n(3)
      do i = 1, gas%boxes%n(1)
        x = gas%mesh%in_metres(gas%boxes%lo + [i, 1, k] - 1.5_wp) - axis
        r = hypot(x(1), x(3))
        if (gas%space%area(i, 1, k, 1) > 0.999_wp) squares = squares + [(gas%velocity(i, 1, k, 1) - fast*x(3))**2, 1.0_wp]
        if (gas%space%area(i, 1, k, 3) > 0.999_wp) squares = squares + [(gas%velocity(i, 1, k, 3) + fast*x(1))**2, 1.0_wp]
        if (r < 0.3_wp*radius) sums(1:2) = sums(1:2) + [gas%pressure(i, 1, k) - 0.5_wp*gas%density*(fast*r)**2, 1.0_wp]
        if (r > 0.7_wp*radius .and. gas%space%volume(i, 1, k) > 0.999_wp) sums(3:4) = sums(3:4) &
          + [(gas%pressure(i, 1, k) - 0.5_wp*gas%density*(fast*r)**2), 1.0_wp]
      end do
    end do
    squares = comm%sum(squares)
    error = sqrt(squares(1)/squares(2))/(fast*radius)
    sums = comm%sum(sums)
    fall = 1 + (sums(3)/sums(4) - sums(1)/sums(2))/(0.5_wp*gas%density*(fast*radius)**2)
    if (comm%is_root()) call expect(ok, 'gas in a drum converges')
    call gas%destroy()
  end subroutine drum

  !> A slice periodic along y, n cells over a width in x and z and one more at either end, of a gas as thick as oil.
  subroutine round_scene(n, radius, scene, axis)
    integer, intent(in) :: n
    real(wp), intent(in) :: radius  !< [m]
    type(scene_t), intent(out) :: scene
    real(wp), intent(out) :: axis(3)  !< a point of it [m]

    real(wp) :: h

    h = 2*radius/n
    scene = flow_scene([n + 2, 3, n + 2]*h, [n + 2, 3, n + 2], [.false., .true., .false.])
    scene%settings%pressure_drop = o
    allocate (scene%records(0))
    scene%numerics%velocity_tolerance = 1.0e-7_wp
    axis = 0.5_wp*scene%upper + [0.21_wp, o, -0.13_wp]*h
  end subroutine round_scene

  !> Between a cylinder that turns and one at rest: u = A r + B/r.
  subroutine between_cylinders()
    real(wp) :: error(2)
    integer :: m

    do m = 1, 2
      call annulus(16*m, error(m))
    end do
    if (.not. comm%is_root()) return
    call expect_close(error(2), o, 0.01_wp, 'between cylinders one of which turns')
    call expect(error(2) < 0.55_wp*error(1), 'nearer on the finer grid')
  end subroutine between_cylinders

  !> Root of the mean square error in cells that are not cut, over the speed of the inner wall.
  subroutine annulus(n, error)
    integer, intent(in) :: n
    real(wp), intent(out) :: error

    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: axis(3), sums(2), half(3)
    integer :: i, k
    logical :: ok

    call round_scene(n, outer, scene, axis)
    scene%walls = [pipe(axis, 2, outer), pipe(axis, 2, inner)]
    scene%walls(2)%side = 'outside'
    scene%walls(2)%gas_side = 'outside'
    scene%walls(2)%angular_velocity = [o, spin, o]
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 20, 0.01_wp)
    sums = o
    do k = 1, gas%boxes%n(3)
      do i = 1, gas%boxes%n(1)
        associate (x => gas%mesh%in_metres(gas%boxes%lo + [i, 1, k] - 1.5_wp) - axis, area => gas%space%area(i, 1, k, :))
          half = 0.5_wp*gas%mesh%finest
          if (area(1) > 0.999_wp) sums = sums &
            + [(gas%velocity(i, 1, k, 1) - x(3)*rate(hypot(x(1) + half(1), x(3))))**2, 1.0_wp]
          if (area(3) > 0.999_wp) sums = sums &
            + [(gas%velocity(i, 1, k, 3) + x(1)*rate(hypot(x(1), x(3) + half(3))))**2, 1.0_wp]
        end associate
      end do
    end do
    sums = comm%sum(sums)
    error = sqrt(sums(1)/sums(2))/(spin*inner)
    if (comm%is_root()) call expect(ok, 'gas between cylinders converges')
    call gas%destroy()
  end subroutine annulus

  !> u/r between the cylinders [1/s].
  pure function rate(r)
    real(wp), intent(in) :: r  !< [m]
    real(wp) :: rate

    rate = spin*inner**2/(outer**2 - inner**2)*(outer**2/r**2 - 1)
  end function rate

  !> A pipe whose surface runs along its axis takes the gas in it along.
  subroutine running_pipe()
    real(wp), parameter :: speed = 0.4_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: axis(3), worst
    logical :: ok

    call round_scene(8, 0.01_wp, scene, axis)
    scene%numerics%velocity_tolerance = 1.0e-11_wp
    scene%walls = [pipe(axis, 2, 0.01_wp)]
    scene%walls(1)%velocity = [o, speed, o]
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 4, 100.0_wp)
    associate (n => gas%boxes%n)
      worst = maxval(abs(gas%velocity(1:n(1), 1:n(2), 1:n(3), 2) - speed*gas%free(1:n(1), 1:n(2), 1:n(3), 2)), &
                     gas%free(1:n(1), 1:n(2), 1:n(3), 2) > o)
    end associate
    worst = comm%max(worst)
    if (comm%is_root()) then
      call expect(ok, 'gas in a pipe that runs converges')
      call expect_close(worst/speed, o, 1.0e-7_wp, 'and runs with it')
    end if
    call gas%destroy()
  end subroutine running_pipe

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
