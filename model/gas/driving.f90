!> What drives the gas along periodic directions: a given pressure drop, or the one that keeps a given mass flow.
!>
!> The pressure is p - x dp/L with p periodic: the drop dp acts as a body force eps dp/L on the gas, and as a pressure
!> gradient on what moves in it. Where the flow is given, dp belongs to the unknowns of a step. The momentum equation of
!> its start, solved for a drop of 1 Pa and made to conserve mass, gives the response w of the velocities; after every
!> pressure correction dp grows by what is missing in the flow over the flow of w, and the velocities by that times w. In
!> linear flow this is exact, whatever the step, the drag and the walls.
module driving
  use gas_state, only: gas_state_t
  use kinds, only: wp
  use momentum, only: assemble_momentum, drive
  use pressure_correction, only: update_flux, find_imbalance, correct
  implicit none
  private
  public :: find_responses, keep_flow

  real(wp), parameter :: exactness = 1.0e-6_wp  !< of the response: of its momentum, and of its continuity
  integer, parameter :: passes = 20             !< over the directions, whose flows depend on each other's drop a little

contains

  !> Responses of velocity, pressure and flow to the drop along each direction whose flow is given.
  subroutine find_responses(state)
    class(gas_state_t), intent(inout) :: state

    real(wp), allocatable :: velocity(:,:,:,:), pressure(:,:,:), storage(:,:,:)
    real(wp) :: sums(2)
    integer :: b

    if (.not. any(state%driving%held)) return
    allocate (velocity, source=state%velocity)
    allocate (pressure, source=state%pressure)
    allocate (storage, source=state%storage)
    state%storage = 0.0_wp
    call assemble_momentum(state, sums)
    do b = 1, 3
      if (.not. state%driving%held(b)) cycle
      call find_response(state, b)
      state%driving%response(b)%velocity = state%velocity
      state%driving%response(b)%pressure = state%pressure
      state%driving%response(b)%flow = flow_through(state)
    end do
    state%velocity = velocity
    state%pressure = pressure
    state%storage = storage
    call update_flux(state)
  end subroutine find_responses

  !> Velocity, pressure and flux of one response, in the place of those of the state.
  subroutine find_response(state, b)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: b

    real(wp) :: sums(2), imbalance
    integer :: a

    state%velocity = 0.0_wp
    state%pressure = 0.0_wp
    do a = 1, 3
      if (.not. state%stencil(a)%active) cycle
      state%stencil(a)%rhs = 0.0_wp
      if (a /= b) cycle
      associate (lo => state%stencil(a)%lo, n => state%stencil(a)%n)
        call drive(lo, n, a, state%spacing(a)%gap/(state%mesh%upper(a) - state%mesh%lower(a)), &
                   state%passage(:, :, :, a)*state%free(:, :, :, a), state%stencil(a)%rhs)
      end associate
    end do
    sums = state%momentum%residual(state%stencil, state%velocity, state%boxes%comm)
    call state%momentum%solve(state%stencil, state%velocity, sums(1), exactness, state%halo, state%boxes%comm)
    call update_flux(state)
    imbalance = find_imbalance(state)
    if (imbalance > exactness*maxval(abs(flow_through(state)))) call correct(state, exactness)
    call update_flux(state)
  end subroutine find_response

  !> Give the flow its value.
  subroutine keep_flow(state)
    class(gas_state_t), intent(inout) :: state

    real(wp) :: missing(3), change(3), step
    integer :: b, pass

    if (.not. any(state%driving%held)) return
    call update_flux(state)
    missing = state%driving%flow - flow_through(state)
    change = 0.0_wp
    do pass = 1, passes
      do b = 1, 3
        if (.not. state%driving%held(b)) cycle
        associate (gain => state%driving%response(b)%flow)
          step = missing(b)/gain(b)
          change(b) = change(b) + step
          missing = missing - step*gain
        end associate
      end do
    end do
    state%driving%drop = state%driving%drop + change
    do b = 1, 3
      if (.not. state%driving%held(b)) cycle
      state%velocity = state%velocity + change(b)*state%driving%response(b)%velocity
      state%pressure = state%pressure + change(b)*state%driving%response(b)%pressure
    end do
  end subroutine keep_flow

  !> Mass flow along each direction, the mean over all planes across it [kg/s].
  function flow_through(state) result(flow)
    class(gas_state_t), intent(in) :: state
    real(wp) :: flow(3)

    integer :: a

    associate (n => state%boxes%n)
      flow = [(sum(state%flux(1:n(1), 1:n(2), 1:n(3), a))/state%mesh%n(a), a=1, 3)]
    end associate
    flow = state%boxes%comm%sum(flow)
  end function flow_through

end module driving
