!> Walls within the domain whose surface runs along itself: belts, drums, rods.
! ranks: 1 2
program test_moving_walls
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use gas, only: gas_t
  use gas_cases, only: scene_t, make_gas, steps
  use kinds, only: wp
  use laminar_flows, only: flow_scene
  use mesh_scenes, only: mesh, tube
  use outcome, only: outcome_t
  use pipe_flow, only: pipe, round_scene
  use surface, only: new_surface
  implicit none

  real(wp), parameter :: o = 0.0_wp, edge = 2.0e-3_wp
  real(wp), parameter :: outer = 0.01_wp, inner = 0.004_wp, spin = 0.5_wp  !< of two cylinders [m], [rad/s]
  type(communicator_t) :: comm
  integer :: a

  call start_ranks(comm)
  do a = 1, 3
    call belt(a, 'none')
    call belt(a, 'smagorinsky')
  end do
  call drums()
  call between_cylinders()
  call running_pipe()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

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

end program test_moving_walls
