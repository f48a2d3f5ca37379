!> One implicit step of the gas: SIMPLE iterations until mass and momentum balance.
!>
!> Patankar and Spalding, Int. J. Heat Mass Transfer 15 (1972) 1787, in the SIMPLEC form, which needs no
!> under-relaxation: momentum predicts velocities, the pressure correction makes them conserve mass, and what that
!> does to momentum is seen at the start of the next iteration, where the step ends when it is small enough.
module simple_step
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use driving, only: find_responses, keep_flow
  use eddy_viscosity, only: find_eddies
  use gas_boundary, only: set_inflow
  use gas_density, only: begin_density, follow_pressure, heed_round_off, pressed_flow
  use gas_state, only: gas_state_t, gas_report_t, find_density, vents
  use kinds, only: wp
  use mesh, only: unit_step
  use momentum, only: prepare_momentum, assemble_momentum
  use momentum_cells, only: fill_beyond
  use pressure_correction, only: prepare_faces, prepare_pressure, update_flux, find_imbalance, correct
  implicit none
  private
  public :: advance_state, restore_state

  real(wp), parameter :: sweep_reduction = 0.1_wp     !< of the momentum residual by the linear solver per iteration
  real(wp), parameter :: usual_reduction = 0.1_wp     !< of the mass imbalance by the pressure solver per iteration
  real(wp), parameter :: tightest = 1.0e-13_wp        !< reduction that round-off still allows
  real(wp), parameter :: margin = 0.3_wp              !< how far below the tolerance the pressure solver aims
  real(wp), parameter :: nearly = 3.0_wp              !< times the velocity tolerance: one more iteration will do
  real(wp), parameter :: hopeless = 1.0e6_wp          !< times its scale: a mass residual that will not come back

contains

  !> Take the gas from t to t + dt. If it does not converge everything but the report is as it was.
  subroutine advance_state(state, dt, converged)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(in) :: dt  !< [s]
    logical, intent(out) :: converged

    real(wp) :: force_scale, first, mass, sums(2)
    integer :: iteration

    state%report = gas_report_t()
    state%momentum%sweeps = 0
    converged = .false.
    if (.not. inputs_are_numbers(state)) return
    call begin_step(state, dt, force_scale, mass)
    do iteration = 0, state%numerics%maximum_iterations
      call assemble_momentum(state, sums)
      call judge(state, mass, force_scale, sums, first)
      converged = state%report%mass_residual <= state%numerics%tolerance .and. iteration > 0 .and. &
                  state%report%momentum_residual <= state%numerics%velocity_tolerance
      if (converged .or. iteration == state%numerics%maximum_iterations .or. lost(state)) exit
      call predict_velocity(state, first)
      call correct_pressure(state, mass)
      state%report%iterations = iteration + 1
    end do
    if (converged) call report_flows(state, dt)
    if (.not. converged) call restore_state(state)
  end subroutine advance_state

  !> Everything that holds for the whole step.
  subroutine begin_step(state, dt, force_scale, mass)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(in) :: dt
    real(wp), intent(out) :: force_scale  !< sum of the forces that do not change in the step [N]
    real(wp), intent(out) :: mass         !< sum of the cells' |imbalance| [kg/s]

    state%velocity_before = state%velocity
    state%pressure_before = state%pressure
    state%driving%drop_before = state%driving%drop
    call state%solver%remember()
    call set_inflow(state%boundary, state%time + dt)
    call gather_forces(state%boxes%n, state%drag, state%drag_source, state%forces)
    call state%halo%exchange(state%eps)
    call state%halo%exchange_many(state%forces)
    call prepare_faces(state, dt)
    if (allocated(state%ideal)) call begin_density(state, dt)
    call state%halo%exchange_many(state%velocity)
    if (allocated(state%eddies)) call find_eddies(state)
    call prepare_momentum(state, dt)
    call prepare_pressure(state)
    call fill_beyond(state)
    call update_flux(state)
    call find_responses(state)
    state%report%mass_scale = mass_scale(state, dt)
    mass = find_imbalance(state)
    force_scale = state%boxes%comm%sum(sizes(size(state%source), state%source))
    if (allocated(state%ideal)) call heed_round_off(state, force_scale)
  end subroutine begin_step

  !> Drag and its source side by side.
  pure subroutine gather_forces(n, drag, drag_source, forces)
    integer, intent(in) :: n(3)
    real(wp), intent(in) :: drag(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2)
    real(wp), intent(in) :: drag_source(3, -1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2)
    real(wp), intent(inout) :: forces(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2, 4)

    integer :: i, j, k

    do k = 1, n(3)
      do j = 1, n(2)
        do i = 1, n(1)
          forces(i, j, k, 1) = drag(i, j, k)
          forces(i, j, k, 2) = drag_source(1, i, j, k)
          forces(i, j, k, 3) = drag_source(2, i, j, k)
          forces(i, j, k, 4) = drag_source(3, i, j, k)
        end do
      end do
    end do
  end subroutine gather_forces

  !> What mass residuals are measured by: the inflow; without one the flow that goes round or is asked for, the gas that
  !> moving particles push, or what gravity and pressure drop would set in motion in one step if nothing held it, as would the
  !> pressure of an ideal gas, whichever is largest [kg/s].
  function mass_scale(state, dt) result(scale)
    class(gas_state_t), intent(in) :: state
    real(wp), intent(in) :: dt
    real(wp) :: scale

    integer :: a
    real(wp) :: flows(4), face(3)

    scale = state%density*state%boundary%inflow
    if (scale > 0.0_wp) return
    associate (n => state%boxes%n, m => state%mesh)
      do a = 1, 3
        flows(a) = sum(abs(state%flux(1:n(1), 1:n(2), 1:n(3), a)))/m%n(a)
      end do
      flows(4) = sum(abs(state%storage))
      flows = state%boxes%comm%sum(flows)
      associate (driving => state%driving, extent => m%upper - m%lower)
        face = product(extent/m%n)/(extent/m%n)
        scale = max(maxval(flows), maxval(state%density*face*abs(state%gravity)*dt))
        scale = max(scale, maxval(abs(driving%flow)), maxval(face*abs(driving%drop)/extent*dt))
        if (allocated(state%ideal)) scale = max(scale, maxval(pressed_flow(state)))
      end associate
    end associate
  end function mass_scale

  !> Residuals of the velocities and pressures at hand, relative.
  subroutine judge(state, mass, force_scale, mine, first)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(in) :: mass, force_scale
    real(wp), intent(in) :: mine(2)  !< what assemble_momentum found on this rank
    real(wp), intent(out) :: first   !< momentum residual [N]

    real(wp) :: sums(2)

    sums = state%boxes%comm%sum(mine)
    first = sums(1)
    state%report%momentum_residual = ratio(sums(1), force_scale + sums(2))
    state%report%mass_residual = ratio(mass, state%report%mass_scale)
  end subroutine judge

  !> Sum of |x|.
  pure function sizes(n, x) result(total)
    integer, intent(in) :: n
    real(wp), intent(in) :: x(n)
    real(wp) :: total

    integer :: i

    total = 0.0_wp
    !$omp simd reduction(+:total)
    do i = 1, n
      total = total + abs(x(i))
    end do
  end function sizes

  !> x/y, and 0 for nothing of nothing.
  pure function ratio(x, y)
    real(wp), intent(in) :: x, y
    real(wp) :: ratio

    ratio = x
    if (y > 0.0_wp) ratio = x/y
  end function ratio

  !> Velocities that satisfy momentum with the pressure at hand.
  subroutine predict_velocity(state, first)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(in) :: first

    call state%momentum%solve(state%stencil, state%velocity, first, sweep_reduction, state%halo, state%boxes%comm)
  end subroutine predict_velocity

  !> Pressure and velocities that satisfy continuity, as closely as the momentum residual makes worthwhile.
  subroutine correct_pressure(state, mass)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(out) :: mass  !< sum of |imbalance| that is left [kg/s]

    real(wp) :: aim, reduction

    call update_flux(state)
    mass = find_imbalance(state)
    aim = margin*state%numerics%tolerance*state%report%mass_scale
    reduction = usual_reduction
    if (mass > 0.0_wp) then
      if (state%report%momentum_residual <= nearly*state%numerics%velocity_tolerance) reduction = aim/mass
      reduction = min(max(reduction, aim/mass, tightest), usual_reduction)
    end if
    call correct(state, reduction)
    call keep_flow(state)
    if (allocated(state%ideal)) call follow_pressure(state)
    call fill_beyond(state)
    call update_flux(state)
    mass = find_imbalance(state)
  end subroutine correct_pressure

  !> Whether a step cannot be saved: not a number, or far away, or a vacuum.
  pure function lost(state)
    class(gas_state_t), intent(in) :: state
    logical :: lost

    associate (mass => state%report%mass_residual, momentum => state%report%momentum_residual)
      lost = is_not_a_number(mass) .or. is_not_a_number(momentum)
      if (.not. lost) lost = state%report%iterations > 1 .and. mass > hopeless
      if (allocated(state%ideal) .and. .not. lost) lost = .not. state%ideal%least > 0.0_wp
    end associate
  end function lost

  !> Does not raise a floating-point exception, as comparisons by size would.
  pure function is_not_a_number(x)
    real(wp), intent(in) :: x
    logical :: is_not_a_number

    is_not_a_number = .not. ieee_is_finite(x)
  end function is_not_a_number

  !> Whether what coupling hands over is finite; all ranks get the same answer.
  function inputs_are_numbers(state) result(ok)
    class(gas_state_t), intent(in) :: state
    logical :: ok

    associate (n => state%boxes%n)
      ok = .not. state%boxes%comm%any_of(is_not_a_number( &
        sum(state%eps(1:n(1), 1:n(2), 1:n(3))) + sum(state%drag(1:n(1), 1:n(2), 1:n(3))) &
        + sum(state%drag_source(:, 1:n(1), 1:n(2), 1:n(3)))))
    end associate
  end function inputs_are_numbers

  !> The gas as it was before the last step.
  subroutine restore_state(state)
    class(gas_state_t), intent(inout) :: state

    state%velocity = state%velocity_before
    state%pressure = state%pressure_before
    state%driving%drop = state%driving%drop_before
    call state%solver%recall()
    if (allocated(state%ideal)) call find_density(state)
  end subroutine restore_state

  !> The mass balance of the whole domain over the step, from the fluxes themselves.
  subroutine report_flows(state, dt)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(in) :: dt

    integer :: a, end, lo(3), hi(3)
    real(wp) :: sums(3), inward, courant

    sums = 0.0_wp
    courant = 0.0_wp
    associate (n => state%boxes%n, report => state%report)
      do a = 1, 3
        courant = max(courant, fastest(n, a, state%spacing(a)%width, state%velocity(:, :, :, a))*dt)
        do end = 1, 2
          if (.not. state%boundary%side(end, a)%mine) cycle
          lo = 1
          hi = n
          lo(a) = merge(0, n(a), end == 1)
          hi(a) = lo(a)
          inward = merge(1.0_wp, -1.0_wp, end == 1)
          associate (g => state%flux(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), a), &
                     free => state%free(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), a))
            sums(1) = sums(1) + inward*sum(g*(1 - free))
            sums(2) = sums(2) - inward*sum(g*free)
          end associate
        end do
      end do
      sums(3) = sum(state%storage)
      if (allocated(state%seep)) sums = sums + [1, 0, 1]*sum(state%seep(1:n(1), 1:n(2), 1:n(3)))
      if (vents(state)) sums(2) = sums(2) + state%vented
      sums = state%boxes%comm%sum(sums)
      report%inflow = sums(1)
      report%outflow = sums(2)
      report%accumulation = sums(3)
      report%mass_imbalance = ratio(abs(sums(1) - sums(2) - sums(3)), report%mass_scale)
      report%courant = state%boxes%comm%max(courant)
      report%sweeps = state%momentum%sweeps
    end associate
  end subroutine report_flows

  !> Largest |u|/h of component a over my cells [1/s].
  pure function fastest(n, a, width, u) result(rate)
    integer, intent(in) :: n(3), a
    real(wp), intent(in) :: width(-1:n(a) + 2)
    real(wp), intent(in) :: u(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2)
    real(wp) :: rate

    integer :: i, j, k, e(3)

    e = unit_step(a)
    rate = 0.0_wp
    do k = 1, n(3)
      do j = 1, n(2)
        !$omp simd reduction(max:rate)
        do i = 1, n(1)
          rate = max(rate, abs(u(i, j, k))/width(e(1)*i + e(2)*j + e(3)*k))
        end do
      end do
    end do
  end function fastest

end module simple_step
