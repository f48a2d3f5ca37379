!> The gas on graded grids: order of accuracy, the same as on equal cells where cells are equal, rest stays rest.
program test_gas_graded
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas, set_cells, steps, wavy_void, uneven_drag
  use grid_axis, only: axis_t, uniform_axis, graded_axis, graded_faces
  use kinds, only: wp
  use laminar_flows, only: flow_scene, gap, viscosity
  use momentum_cells, only: sweep_t, new_sweep, find_crossing
  use outcome, only: outcome_t
  use pressure_correction, only: prepare_faces
  use vortex_flow, only: decay
  implicit none

  real(wp), parameter :: o = 0.0_wp, top(3) = [0.04_wp, 0.08_wp, 0.02_wp]
  type(communicator_t) :: comm

  call start_ranks(comm)
  call equal_cells()
  call linear_fields()
  call plates()
  call vortices()
  call rest()
  call plug()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> A bed of uneven void fraction and drag with inflow, outflow and walls.
  subroutine make_bed(axis, gas)
    type(axis_t), intent(in) :: axis(3)
    type(gas_t), intent(out) :: gas

    type(scene_t) :: scene
    type(outcome_t) :: outcome

    scene%upper = top
    scene%cells = axis%n
    scene%axis = axis
    scene%gravity = [o, -9.81_wp, o]
    scene%numerics%tolerance = 1.0e-12_wp
    scene%numerics%velocity_tolerance = 1.0e-11_wp
    scene%records = [record('bottom', 'inflow', [o, o, o], [top(1), o, top(3)], velocity=0.4_wp), &
                     record('top', 'outflow', [o, top(2), o], top)]
    call make_gas(comm, scene, gas, outcome)
    call set_cells(gas%boxes, wavy_void, gas%eps)
    call gas%accept()
    call set_cells(gas%boxes, uneven_drag, gas%drag)
  end subroutine make_bed

  !> Equal cells given as graded ones take the other branches and give the same flow.
  subroutine equal_cells()
    type(gas_t) :: even, graded
    type(axis_t) :: axis(3), same(3)
    integer :: a
    real(wp) :: difference

    do a = 1, 3
      axis(a) = uniform_axis(o, top(a), nint(top(a)/5.0e-3_wp), .false.)
      same(a) = graded_axis(axis(a)%face, .false.)
    end do
    call make_bed(axis, even)
    call make_bed(same, graded)
    call expect(steps(even, 3, 1.0e-3_wp) .and. steps(graded, 3, 1.0e-3_wp), 'both beds converge')
    difference = comm%max(maxval(abs(even%velocity - graded%velocity)))
    call expect_close(difference, o, 1.0e-9_wp, 'equal cells given as graded ones: the same velocities')
    call expect(comm%max(maxval(abs(even%velocity))) > 0.4_wp, 'there is a flow')
    call even%destroy()
    call graded%destroy()
  end subroutine equal_cells

  !> On graded cells a void fraction that is linear in y is exact on faces, so is a velocity on the faces of momentum cells,
  !> by central differences and by van Leer alike, and friction has the areas and distances of the grid.
  subroutine linear_fields()
    character(len=8), parameter :: scheme(2) = [character(len=8) :: 'central', 'van_leer']
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    integer :: m, a, way

    if (comm%size > 1) return
    do m = 1, size(scheme)
      scene%upper = top
      scene%cells = [6, 8, 4]
      scene%numerics%limiter = scheme(m)
      scene%axis = [(graded_axis(graded_faces([o, top(a)], scene%cells(a:a), [2.0_wp]), .false.), a=1, 3)]
      scene%records = [record('top', 'outflow', [o, top(2), o], top)]
      call make_gas(comm, scene, gas, outcome)
      call check_passages(gas)
      do way = -1, 1
        do a = 1, 3
          call check_crossing(gas, a, way, trim(scheme(m)))
        end do
      end do
      call gas%destroy()
    end do
  end subroutine linear_fields

  subroutine check_passages(gas)
    type(gas_t), intent(inout) :: gas

    integer :: j
    real(wp) :: worst

    do j = 1, 8
      gas%eps(1:6, j, 1:4) = 0.4_wp + 5*gas%mesh%axis(2)%in_metres(j - 0.5_wp)
    end do
    call prepare_faces(gas, 1.0_wp)
    worst = o
    do j = 1, 7
      worst = max(worst, abs(gas%passage(2, j, 3, 2)/(gas%spacing(1)%width(2)*gas%spacing(3)%width(3)) &
                             - 0.4_wp - 5*gas%mesh%axis(2)%face(j)))
    end do
    call expect_close(worst, o, 1.0e-13_wp, 'a linear void fraction is exact on graded faces')
  end subroutine check_passages

  !> Component a, along y; `way` is the direction of the flow, 0 for none.
  subroutine check_crossing(gas, a, way, scheme)
    type(gas_t), intent(inout) :: gas
    integer, intent(in) :: a, way
    character(len=*), intent(in) :: scheme

    real(wp), parameter :: flow = 0.7_wp
    type(sweep_t) :: sweep
    real(wp) :: worst, u(-1:10), face, length(3), crossing(-1:6, 3)
    integer :: j

    gas%eps = 1.0_wp
    gas%flux = way*flow
    do j = 0, 8
      u(j) = 2 + 30*gas%mesh%axis(2)%in_metres(j - merge(o, 0.5_wp, a == 2))
      gas%velocity(:, j, :, a) = u(j)
    end do
    call new_sweep(gas, a, 2, sweep)
    worst = o
    do j = 2, 6
      call find_crossing(gas, sweep, [j, 2], crossing)
      face = 2 + 30*gas%mesh%axis(2)%in_metres(j + merge(0.5_wp, o, a == 2))
      if (way > 0) worst = max(worst, abs(u(j) + crossing(3, 3)/flow - face))
      if (way < 0) worst = max(worst, abs(u(j + 1) - crossing(3, 3)/flow - face))
      if (way /= 0) cycle
      length = [gas%spacing(1)%width(3), gas%spacing(2)%gap(j), gas%spacing(3)%width(2)]
      if (a == 1) length(1) = 0.5_wp*(gas%spacing(1)%width(3) + gas%spacing(1)%width(4))
      if (a == 3) length(3) = 0.5_wp*(gas%spacing(3)%width(2) + gas%spacing(3)%width(3))
      if (a == 2) length(2) = gas%spacing(2)%width(j + 1)
      worst = max(worst, maxval(abs(crossing(3, 1:2)/(gas%viscosity*length(1)*length(3)/length(2)) - 1)))
    end do
    call expect_close(worst, o, 1.0e-11_wp, 'a linear velocity and its friction are exact on graded cells, '//scheme)
  end subroutine check_crossing

  !> Between plates on cells that widen fourfold towards one of them: second order.
  subroutine plates()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp), parameter :: length = 0.2_wp, drop = 240.0_wp
    real(wp) :: error(3), y
    integer :: level, n, j

    do level = 1, 3
      n = 8*2**level
      scene = flow_scene([length, gap, gap], [4, n, 1], [.true., .false., .true.])
      allocate (scene%records(0))
      scene%axis = [uniform_axis(o, length, 4, .true.), graded_axis(graded_faces([o, gap], [n], [4.0_wp]), .false.), &
                    uniform_axis(o, gap, 1, .true.)]
      call make_gas(comm, scene, gas, outcome)
      call expect(steps(gas, 4, 10.0_wp), 'plates on graded cells converge')
      error(level) = o
      do j = 1, gas%boxes%n(2)
        y = gas%mesh%axis(2)%in_metres(gas%boxes%lo(2) + j - 1.5_wp)
        error(level) = max(error(level), maxval(abs(gas%velocity(1:gas%boxes%n(1), j, 1, 1) &
                                                    - drop/length*y*(gap - y)/(2*viscosity))))
      end do
      error(level) = comm%max(error(level))
      call gas%destroy()
    end do
    call expect(log(error(2)/error(3))/log(2.0_wp) > 1.9_wp, 'plates on graded cells: second order')
    call expect(error(3) < 2.0e-2_wp, 'and within 0.13 % of 15 m/s on 64 cells')
  end subroutine plates

  !> Vortices on cells of 0.7 to 1.3 times the mean width: convection and pressure are of second order, too.
  subroutine vortices()
    real(wp) :: error(3), amplitude(2)
    integer :: level, iterations
    character(len=8), parameter :: scheme(2) = [character(len=8) :: 'central', 'van_leer']
    integer :: m

    do m = 1, 2
      do level = 1, 3
        call decay(comm, 8*2**level, trim(scheme(m)), 0.1_wp, 10, error(level), amplitude, iterations, wave=0.3_wp)
        call expect(iterations > 0, 'vortices on graded cells converge')
      end do
      call expect(log(error(2)/error(3))/log(2.0_wp) > 1.8_wp, 'vortices on graded cells: second order, '//scheme(m))
    end do
  end subroutine vortices

  !> Gas at rest under gravity stays there, with a pressure that its weight gives.
  subroutine rest()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: difference
    integer :: j

    scene%upper = top
    scene%cells = [4, 12, 2]
    scene%gravity = [o, -9.81_wp, o]
    scene%axis = [uniform_axis(o, top(1), 4, .false.), graded_axis(graded_faces([o, top(2)], [12], [5.0_wp]), .false.), &
                  uniform_axis(o, top(3), 2, .false.)]
    scene%numerics%velocity_tolerance = 1.0e-10_wp
    scene%records = [record('top', 'outflow', [o, top(2), o], top)]
    call make_gas(comm, scene, gas, outcome)
    call expect(steps(gas, 3, 1.0e-2_wp), 'gas at rest converges')
    difference = o
    do j = 1, gas%boxes%n(2)
      difference = max(difference, maxval(abs(gas%pressure(1:gas%boxes%n(1), j, 1:gas%boxes%n(3)) &
        - gas%density*9.81_wp*(top(2) - gas%mesh%axis(2)%in_metres(gas%boxes%lo(2) + j - 1.5_wp)))))
    end do
    call expect_close(comm%max(difference), o, 1.0e-9_wp, 'pressure of the weight above')
    call expect_close(comm%max(maxval(abs(gas%velocity))), o, 1.0e-9_wp, 'gas at rest on graded cells')
    call gas%destroy()
  end subroutine rest

  !> Through an even plug with slip walls the pressure falls by beta u over its height.
  subroutine plug()
    type(gas_t) :: gas
    type(scene_t) :: scene
    type(outcome_t) :: outcome
    real(wp), parameter :: resistance = 2000.0_wp, speed = 0.3_wp  ! [kg/(m3 s)], [m/s]
    real(wp) :: difference
    integer :: j

    scene%upper = top
    scene%cells = [4, 12, 2]
    scene%axis = [uniform_axis(o, top(1), 4, .false.), graded_axis(graded_faces([o, top(2)], [12], [5.0_wp]), .false.), &
                  uniform_axis(o, top(3), 2, .false.)]
    scene%records = [record('bottom', 'inflow', [o, o, o], [top(1), o, top(3)], velocity=speed), &
                     record('top', 'outflow', [o, top(2), o], top), &
                     record('left', 'slip', [o, o, o], [o, top(2), top(3)]), record('right', 'slip', [top(1), o, o], top), &
                     record('front', 'slip', [o, o, o], [top(1), top(2), o]), record('back', 'slip', [o, o, top(3)], top)]
    call make_gas(comm, scene, gas, outcome)
    associate (n => gas%boxes%n)
      gas%drag(1:n(1), 1:n(2), 1:n(3)) = resistance*gas%volume(1:n(1), 1:n(2), 1:n(3))
    end associate
    call expect(steps(gas, 20, 1.0e-2_wp), 'the plug converges')
    difference = o
    do j = 1, gas%boxes%n(2)
      difference = max(difference, maxval(abs(gas%pressure(1:gas%boxes%n(1), j, 1:gas%boxes%n(3)) &
        - resistance*speed*(top(2) - gas%mesh%axis(2)%in_metres(gas%boxes%lo(2) + j - 1.5_wp)))))
    end do
    call expect_close(comm%max(difference)/(resistance*speed*top(2)), o, 1.0e-5_wp, 'pressure in a plug of graded cells')
    call gas%destroy()
  end subroutine plug

end program test_gas_graded
