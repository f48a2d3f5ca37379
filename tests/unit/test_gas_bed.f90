!> The gas in a fixed bed: void fraction, drag, mass and gravity against closed forms.
program test_gas_bed
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas, set_cells, steps, &
    wavy_void, uneven_drag
  use kinds, only: wp
  use outcome, only: outcome_t
  implicit none

  real(wp), parameter :: width = 0.032_wp, height = 0.096_wp, speed = 0.01_wp
  integer, parameter :: rows = 24
  type(communicator_t) :: comm

  call start_ranks(comm)
  call porous_plug()
  call uneven_void()
  call filling_void()
  call gas_at_rest()
  call momentum_of_drag()
  call mass_follows_tolerance()
  call mass_flow_through_a_part()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> A column with slip walls, inflow below and outflow above.
  function column() result(scene)
    type(scene_t) :: scene

    real(wp), parameter :: o = 0.0_wp

    scene%upper = [width, height, width]
    scene%cells = [8, rows, 4]
    allocate (scene%records(6))
    scene%records(:) = [record('bottom', 'inflow', [o, o, o], [width, o, width], velocity=speed), &
                     record('top', 'outflow', [o, height, o], [width, height, width], pressure=100.0_wp), &
                     record('west', 'slip', [o, o, o], [o, height, width]), &
                     record('east', 'slip', [width, o, o], [width, height, width]), &
                     record('front', 'slip', [o, o, o], [width, height, o]), &
                     record('back', 'slip', [o, o, width], [width, height, width])]
    scene%numerics%tolerance = 1.0e-10_wp
    scene%numerics%velocity_tolerance = 1.0e-10_wp
  end function column

  !> Ergun's bed of 500 um at voidage 0.4 and 0.01 m/s: 611.4375 Pa/m. Model A: dp/dx eps V = drag u, u = U/eps.
  subroutine porous_plug()
    real(wp), parameter :: eps = 0.4_wp, gradient = 611.4375_wp
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: drag
    logical :: ok

    call make_gas(comm, column(), gas, outcome)
    associate (n => gas%boxes%n)
      drag = gradient*eps**2*product(gas%mesh%finest)/speed
      gas%eps(1:n(1), 1:n(2), 1:n(3)) = eps
      gas%drag(1:n(1), 1:n(2), 1:n(3)) = drag
      call gas%accept()
      ok = steps(gas, 2, 1.0_wp)
      if (comm%is_root()) call expect(ok, 'porous plug converges')
      call expect_mean(first_row(gas, gas%pressure), 100.0_wp + gradient*(height - height/(2*rows)), 1.0e-8_wp, &
                       'porous plug, pressure below')
      call expect_mean(first_row(gas, gas%velocity(:, :, :, 2)), speed/eps, 1.0e-9_wp, 'porous plug, velocity')
    end associate
    call gas%destroy()
  end subroutine porous_plug

  !> u = U/eps_f on every face of a column whose void fraction varies along it, without drag.
  subroutine uneven_void()
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: worst
    integer :: j, row
    logical :: ok

    call make_gas(comm, column(), gas, outcome)
    call set_cells(gas%boxes, wavy_void, gas%eps)
    call gas%accept()
    ok = steps(gas, 3, 1.0e-2_wp)
    worst = 0.0_wp
    do j = 1, gas%boxes%n(2)
      row = gas%boxes%lo(2) + j - 1
      if (row == rows) cycle
      worst = max(worst, maxval(abs(gas%velocity(1:gas%boxes%n(1), j, 1:gas%boxes%n(3), 2) &
        *0.5_wp*(wavy_void([1, row, 1]) + wavy_void([1, row + 1, 1]))/speed - 1)))
    end do
    worst = comm%max(worst)
    if (comm%is_root()) then
      call expect(ok, 'uneven void converges')
      call expect_close(worst, 0.0_wp, 1.0e-9_wp, 'uneven void, U = eps u')
      call expect_close(gas%report%outflow, gas%report%inflow, 1.0e-9_wp, 'uneven void, outflow [kg/s]')
      call expect_close(gas%report%inflow, 1.2_wp*speed*width**2, 1.0e-12_wp, 'uneven void, inflow [kg/s]')
    end if
    call gas%destroy()
  end subroutine uneven_void

  !> A void fraction that falls everywhere pushes gas out: outflow = inflow + rho V (eps_old - eps)/dt.
  subroutine filling_void()
    real(wp), parameter :: dt = 1.0e-2_wp, fall = 1.0e-3_wp
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: growth
    logical :: converged

    call make_gas(comm, column(), gas, outcome)
    gas%eps = gas%eps*0.8_wp
    call gas%accept()
    gas%eps = gas%eps - fall*merge(1.0_wp, 0.0_wp, gas%eps > 0.0_wp)
    call gas%advance(dt, converged)
    growth = -1.2_wp*fall*width**2*height/dt
    if (comm%is_root()) then
      call expect(converged, 'filling void converges')
      call expect_close(gas%report%accumulation, growth, 1.0e-10_wp, 'filling void, accumulation [kg/s]')
      call expect_close(gas%report%outflow, 1.2_wp*speed*width**2 - growth, 1.0e-9_wp, 'filling void, outflow [kg/s]')
    end if
    call gas%destroy()
  end subroutine filling_void

  !> Without flow the pressure is hydrostatic, whatever the void fraction, in an open and in a closed vessel.
  subroutine gas_at_rest()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: h, fastest
    integer :: vessel
    logical :: ok

    do vessel = 1, 2
      scene = column()
      if (vessel == 1) scene%records = scene%records(2:)
      if (vessel == 2) scene%records = scene%records(3:)
      scene%gravity = [0.0_wp, -9.81_wp, 0.0_wp]
      call make_gas(comm, scene, gas, outcome)
      call set_cells(gas%boxes, wavy_void, gas%eps)
      call gas%accept()
      ok = steps(gas, 3, 1.0e-3_wp)
      h = gas%mesh%finest(2)
      fastest = comm%max(maxval(abs(gas%velocity)))
      if (comm%is_root()) then
        call expect(ok, 'gas at rest converges')
        call expect_close(fastest, 0.0_wp, 1.0e-9_wp, 'gas at rest, velocity [m/s]')
      end if
      if (vessel == 1) call expect_mean(first_row(gas, gas%pressure), 100.0_wp + 1.2_wp*9.81_wp*(height - h/2), 1.0e-10_wp, &
                                        'gas at rest, pressure below')
      if (vessel == 2) call expect_mean(first_row(gas, gas%pressure), 0.0_wp, 1.0e-8_wp, 'closed vessel, pressure level')
      call gas%destroy()
    end do
  end subroutine gas_at_rest

  !> The drag on the gas that is reported is the sum over cells of source - drag*cell_velocity.
  subroutine momentum_of_drag()
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp), allocatable :: u(:,:,:,:), gradient(:,:,:,:)
    real(wp) :: sums(3), total(3)
    integer :: a
    logical :: ok

    call make_gas(comm, column(), gas, outcome)
    call set_cells(gas%boxes, wavy_void, gas%eps)
    call set_cells(gas%boxes, uneven_drag, gas%drag)
    gas%drag_source(1, :, :, :) = 0.2_wp*gas%drag
    gas%drag_source(2, :, :, :) = 0.1_wp*gas%drag
    gas%drag_source(3, :, :, :) = -0.3_wp*gas%drag
    call gas%accept()
    ok = steps(gas, 2, 1.0e-3_wp)
    associate (n => gas%boxes%n)
      allocate (u(3, n(1), n(2), n(3)), gradient(3, n(1), n(2), n(3)))
      call gas%cell_velocity(u)
      call gas%cell_pressure_gradient(gradient)
      do a = 1, 3
        sums(a) = sum(gas%drag_source(a, 1:n(1), 1:n(2), 1:n(3)) - gas%drag(1:n(1), 1:n(2), 1:n(3))*u(a, :, :, :))
      end do
    end associate
    sums = comm%sum(sums)
    total = gas%drag_total()
    if (comm%is_root()) then
      call expect(ok, 'momentum of drag converges')
      do a = 1, 3
        call expect_close(total(a), sums(a), 1.0e-11_wp, 'momentum of drag [N]')
      end do
    end if
    call gas%destroy()
  end subroutine momentum_of_drag

  !> The mass residual stays below the tolerance, whichever it is.
  subroutine mass_follows_tolerance()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    integer :: digits
    logical :: ok
    character(len=12) :: text

    do digits = 4, 10, 2
      scene = column()
      scene%records = scene%records(1:2)
      scene%numerics%tolerance = 10.0_wp**(-digits)
      scene%numerics%velocity_tolerance = 1.0e-4_wp
      call make_gas(comm, scene, gas, outcome)
      call set_cells(gas%boxes, wavy_void, gas%eps)
      call set_cells(gas%boxes, uneven_drag, gas%drag)
      ok = steps(gas, 2, 1.0e-3_wp)
      if (comm%is_root()) then
        write (text, '(a,i0)') '1e-', digits
        call expect(ok, 'mass, converges at tolerance '//trim(text))
        call expect(gas%report%mass_residual <= scene%numerics%tolerance, 'mass, residual of the cells within '//trim(text))
        call expect(gas%report%mass_imbalance <= scene%numerics%tolerance, 'mass, imbalance of the whole within '//trim(text))
      end if
      call gas%destroy()
    end do
  end subroutine mass_follows_tolerance

  !> A mass flow through a part of a side enters as given; two regions share the side with its walls.
  subroutine mass_flow_through_a_part()
    real(wp), parameter :: o = 0.0_wp, flow = 2.0e-5_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: above
    integer :: i
    logical :: ok

    scene = column()
    scene%records = [record('jet', 'inflow', [o, o, o], [width/4, o, width/2]), &
                     record('air', 'inflow', [width/2, o, o], [width, o, width], velocity=speed), scene%records(2)]
    scene%records(1)%mass_flow = flow
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 2, 1.0e-3_wp)
    above = 0.0_wp
    associate (n => gas%boxes%n)
      if (gas%boxes%at_low(2)) then
        above = 1.2_wp*product(gas%mesh%finest([1, 3]))*sum(gas%velocity(1:n(1), 0, 1:n(3), 2), &
          spread([(gas%boxes%lo(1) - 1 + i, i=1, n(1))], 2, n(3)) <= 2)
      end if
    end associate
    above = comm%sum(above)
    if (comm%is_root()) then
      call expect(ok, 'jet converges')
      call expect_close(gas%report%inflow, flow + 1.2_wp*speed*width**2/2, 1.0e-12_wp, 'jet and air, inflow [kg/s]')
      call expect_close(above, flow, 1.0e-12_wp, 'jet, inflow [kg/s]')
    end if
    call gas%destroy()
  end subroutine mass_flow_through_a_part

  !> Mean of a field over the lowest row of cells, and its largest departure.
  function first_row(gas, field) result(mean_and_spread)
    type(gas_t), intent(in) :: gas
    real(wp), intent(in) :: field(-1:, -1:, -1:)
    real(wp) :: mean_and_spread(2)

    real(wp) :: sums(2), spread_here

    sums = 0.0_wp
    associate (n => gas%boxes%n)
      if (gas%boxes%at_low(2)) sums = [sum(field(1:n(1), 1, 1:n(3))), real(n(1)*n(3), wp)]
      sums = comm%sum(sums)
      spread_here = 0.0_wp
      if (gas%boxes%at_low(2)) spread_here = maxval(abs(field(1:n(1), 1, 1:n(3)) - sums(1)/sums(2)))
    end associate
    mean_and_spread = [sums(1)/sums(2), comm%max(spread_here)]
  end function first_row

  subroutine expect_mean(mean_and_spread, expected, tolerance, name)
    real(wp), intent(in) :: mean_and_spread(2), expected, tolerance
    character(len=*), intent(in) :: name

    if (.not. comm%is_root()) return
    call expect_close(mean_and_spread(1), expected, tolerance, name)
    call expect_close(mean_and_spread(2), 0.0_wp, max(1.0_wp, abs(expected))*1.0e-7_wp, name//', the same everywhere')
  end subroutine expect_mean

end program test_gas_bed
