!> The mass of the gas against the tolerance it is asked for: a vessel whose void fraction waves from step to step.
program verify_balance
  use check, only: expect, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas
  use kinds, only: wp
  use outcome, only: outcome_t
  use report, only: check_value, point
  implicit none

  integer, parameter :: loosest = 3, tightest = 12  !< tolerances 1e-3 .. 1e-12
  integer, parameter :: steps = 12
  real(wp), parameter :: edge = 4.0e-3_wp, dt = 1.0e-3_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  call decades()
  call floor_of_it()
  call finish()
  call stop_ranks()

contains

  !> What is left falls with the tolerance, decade by decade.
  subroutine decades()
    real(wp) :: cells(loosest:tightest), whole(loosest:tightest), tolerance(loosest:tightest)
    integer :: digits
    logical :: converged

    tolerance = [(10.0_wp**(-digits), digits=loosest, tightest)]
    do digits = loosest, tightest
      call worst(tolerance(digits), 50, cells(digits), whole(digits), converged)
      call expect(converged, 'all steps converge')
      call point('balance_cells', tolerance(digits), cells(digits), tolerance(digits))
      call point('balance_whole', tolerance(digits), whole(digits), tolerance(digits))
    end do
    call check_value('balance_most', maxval(cells/tolerance), 0.0_wp)
    call check_value('balance_least', maxval(tolerance/cells), 0.0_wp)
    call check_value('balance_whole', maxval(whole/tolerance), 0.0_wp)
  end subroutine decades

  !> Where round-off ends it.
  subroutine floor_of_it()
    real(wp) :: cells, whole
    logical :: converged

    call worst(1.0e-15_wp, 15, cells, whole, converged)
    call expect(.not. converged, 'it ends above 1e-15')
    call check_value('balance_floor', cells, 0.0_wp)
    call point('balance_floor', 1.0e-15_wp, cells, 1.0e-15_wp)
  end subroutine floor_of_it

  !> Over the steps, the largest sum of the cells' |imbalance| and the largest imbalance of the whole vessel, over the inflow.
  subroutine worst(tolerance, iterations, cells, whole, converged)
    real(wp), intent(in) :: tolerance
    integer, intent(in) :: iterations  !< most of them
    real(wp), intent(out) :: cells, whole
    logical, intent(out) :: converged  !< in all steps

    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    integer :: step
    logical :: ok

    scene%cells = [8, 20, 6]
    scene%upper = scene%cells*edge
    scene%gravity = [0.0_wp, -9.81_wp, 0.0_wp]
    scene%numerics%tolerance = tolerance
    scene%numerics%maximum_iterations = iterations
    associate (top => scene%upper)
      scene%records = [record('bottom', 'inflow', [0.0_wp, 0.0_wp, 0.0_wp], [top(1), 0.0_wp, top(3)], velocity=0.45_wp), &
                       record('top', 'outflow', [0.0_wp, top(2), 0.0_wp], top)]
    end associate
    call make_gas(comm, scene, gas, outcome)
    call wave(gas, 0)
    call gas%accept()
    cells = 0.0_wp
    whole = 0.0_wp
    converged = .true.
    do step = 1, steps
      call wave(gas, step)
      call gas%advance(dt, ok)
      call gas%accept()
      converged = converged .and. ok
      cells = max(cells, gas%report%mass_residual)
      whole = max(whole, gas%report%mass_imbalance)
    end do
    call gas%destroy()
  end subroutine worst

  !> Void fraction and drag of a step.
  subroutine wave(gas, step)
    type(gas_t), intent(inout) :: gas
    integer, intent(in) :: step

    integer :: i, j, k
    real(wp) :: solids

    do k = 1, gas%boxes%n(3)
      do j = 1, gas%boxes%n(2)
        do i = 1, gas%boxes%n(1)
          solids = 0.25_wp*(1 + sin(0.9_wp*i + 0.1_wp*step)*cos(0.7_wp*j - 0.2_wp*step)*sin(1.1_wp*k))
          if (j > 12) solids = 0.01_wp
          gas%eps(i, j, k) = 1 - solids
          gas%drag(i, j, k) = 3.0e-3_wp*solids**2
          gas%drag_source(:, i, j, k) = gas%drag(i, j, k)*[0.3_wp*sin(1.0_wp*j), 0.2_wp*cos(1.0_wp*i), 0.3_wp*sin(1.0_wp*(i + k))]
        end do
      end do
    end do
  end subroutine wave

end program verify_balance
