!> How long the next gas step is: the longest one halved so often that the limits on Courant number and iterations hold.
!>
!> Steps are longest/2**n, so that they fill the beat of the output and a restart file needs n alone. They become shorter
!> at once, by any power of two, and longer slowly, by one, when `patience` in a row were good.
module step_control
  use constants, only: is_set, unset
  use gas_numerics, only: gas_numerics_t, most_halvings
  use kinds, only: wp
  implicit none
  private
  public :: step_limits_t, step_taken_t, step_limits_of, plan_step

  integer, parameter :: patience = 10           !< good steps in a row before they are doubled
  real(wp), parameter :: closeness = 1.0e-6_wp  !< relative: what counts as the same length, or as within a limit

  !> What a case asks for.
  type :: step_limits_t
    real(wp) :: longest = 0               !< [s]
    integer :: deepest = 0                !< the shortest step is longest/2**deepest
    real(wp) :: maximum_courant = unset   !< largest |u| dt/h
    integer :: target_iterations = 0      !< SIMPLE iterations above which steps become shorter, 0: any
  end type step_limits_t

  !> What a step was like that converged.
  type :: step_taken_t
    real(wp) :: time = 0      !< at its end [s]
    real(wp) :: dt = 0        !< [s]
    integer :: retries = 0
    integer :: iterations = 0
    real(wp) :: courant = 0   !< its largest |u| dt/h
  end type step_taken_t

contains

  !> The limits that the keys of &numerics set.
  pure function step_limits_of(numerics) result(limits)
    type(gas_numerics_t), intent(in) :: numerics
    type(step_limits_t) :: limits

    limits = step_limits_t(numerics%time_step, numerics%maximum_halvings, numerics%maximum_courant, numerics%target_iterations)
    if (is_set(numerics%minimum_time_step)) limits%deepest = deepest_halving(numerics%time_step, numerics%minimum_time_step)
  end function step_limits_of

  !> How often `longest` can be halved before it is below `shortest`.
  pure function deepest_halving(longest, shortest) result(deepest)
    real(wp), intent(in) :: longest, shortest  !< [s]
    integer :: deepest

    deepest = 0
    do while (deepest < most_halvings .and. longest/2**(deepest + 1) >= (1 - closeness)*shortest)
      deepest = deepest + 1
    end do
  end function deepest_halving

  !> From the step just taken to the next one. Pure, of numbers that all ranks share: so are the steps.
  pure subroutine plan_step(limits, taken, halvings, good_steps)
    type(step_limits_t), intent(in) :: limits
    type(step_taken_t), intent(in) :: taken
    integer, intent(inout) :: halvings    !< of the step, then of the next one
    integer, intent(inout) :: good_steps  !< in a row, of this length and without a retry

    integer :: least

    least = least_halvings(limits, taken, halvings)
    if (least > halvings) then
      halvings = least
      good_steps = 0
      return
    end if
    if (taken%retries > 0) return
    good_steps = good_steps + 1
    if (good_steps < patience .or. halvings <= least) return
    if (adapts(limits) .and. .not. on_beat(taken%time, limits%longest/2**(halvings - 1))) return
    halvings = halvings - 1
    good_steps = 0
  end subroutine plan_step

  !> How often the next step must be halved, by what the last one tells.
  pure function least_halvings(limits, taken, halvings) result(least)
    type(step_limits_t), intent(in) :: limits
    type(step_taken_t), intent(in) :: taken
    integer, intent(in) :: halvings  !< of the last step
    integer :: least

    real(wp) :: courant  !< of the longest step

    least = 0
    if (is_set(limits%maximum_courant)) then
      courant = taken%courant*limits%longest/taken%dt
      do while (least < limits%deepest .and. courant > (1 + closeness)*limits%maximum_courant)
        least = least + 1
        courant = courant/2
      end do
    end if
    if (limits%target_iterations > 0 .and. taken%iterations > limits%target_iterations) least = max(least, halvings + 1)
    least = min(least, limits%deepest)
  end function least_halvings

  !> Whether there is anything to adapt to but failure.
  pure function adapts(limits)
    type(step_limits_t), intent(in) :: limits
    logical :: adapts

    adapts = is_set(limits%maximum_courant) .or. limits%target_iterations > 0
  end function adapts

  !> Whether steps of this length, from 0, end here.
  pure function on_beat(time, dt)
    real(wp), intent(in) :: time, dt  !< [s]
    logical :: on_beat

    on_beat = abs(time/dt - anint(time/dt)) < 0.25_wp
  end function on_beat

end module step_control
