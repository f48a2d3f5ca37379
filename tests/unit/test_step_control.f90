!> How long the next gas step is.
program test_step_control
  use check, only: expect, finish
  use gas_numerics, only: gas_numerics_t
  use kinds, only: wp
  use step_control, only: step_limits_t, step_taken_t, step_limits_of, plan_step
  implicit none

  call limits_of_keys()
  call without_limits()
  call by_courant()
  call by_iterations()
  call keep_the_beat()
  call finish()

contains

  !> The shortest step is never below the one asked for.
  subroutine limits_of_keys()
    type(gas_numerics_t) :: numerics
    type(step_limits_t) :: limits

    limits = step_limits_of(numerics)
    call expect(limits%deepest == 6 .and. limits%target_iterations == 0, 'by default 6 halvings and no target')
    call expect(abs(limits%longest - 1.0e-3_wp) < 1.0e-15_wp, 'of time_step')
    numerics%minimum_time_step = 1.0e-4_wp
    call expect(deepest(numerics) == 3, '1.25e-4 s is the shortest of 1 ms that is not below 0.1 ms')
    numerics%minimum_time_step = numerics%time_step/8
    call expect(deepest(numerics) == 3, 'an eighth can be had exactly')
    numerics%minimum_time_step = 1.001_wp*numerics%time_step/8
    call expect(deepest(numerics) == 2, 'and a little more than an eighth cannot')
    numerics%minimum_time_step = numerics%time_step
    call expect(deepest(numerics) == 0, 'nor anything below the whole')
  end subroutine limits_of_keys

  pure function deepest(numerics)
    type(gas_numerics_t), intent(in) :: numerics
    integer :: deepest

    type(step_limits_t) :: limits

    limits = step_limits_of(numerics)
    deepest = limits%deepest
  end function deepest

  !> Only failures shorten, and ten good steps in a row double.
  subroutine without_limits()
    integer :: halvings, good_steps, step

    halvings = 3
    good_steps = 0
    call plan_step(step_limits_t(1.0_wp, 6), taken(3, 1, 0.0_wp, retries=1), halvings, good_steps)
    call expect(halvings == 3 .and. good_steps == 0, 'a step that was repeated is not good')
    do step = 1, 9
      call plan_step(step_limits_t(1.0_wp, 6), taken(step, 1000, 1000.0_wp), halvings, good_steps)
    end do
    call expect(halvings == 3 .and. good_steps == 9, 'nine good steps are not enough')
    call plan_step(step_limits_t(1.0_wp, 6), taken(9, 1000, 1000.0_wp), halvings, good_steps)
    call expect(halvings == 2 .and. good_steps == 0, 'ten are, at any time, Courant number and iterations')
    halvings = 0
    good_steps = 9
    call plan_step(step_limits_t(1.0_wp, 6), taken(9, 1, 1.0_wp), halvings, good_steps)
    call expect(halvings == 0 .and. good_steps == 10, 'never above the longest')
  end subroutine without_limits

  !> The least halvings that keep it below, at once.
  subroutine by_courant()
    type(step_limits_t) :: limits
    integer :: halvings, good_steps
    integer :: n

    limits = step_limits_t(1.0_wp, 6, maximum_courant=2.0_wp)
    call expect(next(limits, 0, taken(8, 1, 2.0_wp)) == 0, 'a Courant number at the limit stays')
    call expect(next(limits, 0, taken(8, 1, 2.1_wp)) == 1, 'just above it the step is halved')
    call expect(next(limits, 0, taken(8, 1, 16.5_wp)) == 4, 'far above as often as it takes')
    call expect(next(limits, 0, taken(8, 1, 1.0e9_wp)) == 6, 'but not below the shortest')
    call expect(next(limits, 2, taken(8, 1, 3.9_wp, dt=0.25_wp)) == 3, 'from a step that is short already')
    call expect(next(limits, 2, taken(8, 1, 0.9_wp, dt=0.25_wp), 9) == 1, 'doubled where that keeps it below')
    call expect(next(limits, 2, taken(8, 1, 1.1_wp, dt=0.25_wp), 9) == 2, 'and not where it does not')
    halvings = 2
    good_steps = 3
    do n = 1, 20
      call plan_step(limits, taken(8*n, 1, 1.1_wp, dt=0.25_wp), halvings, good_steps)
    end do
    call plan_step(limits, taken(8, 1, 0.1_wp, dt=0.25_wp), halvings, good_steps)
    call expect(halvings == 1, 'only by one at a time, however small it is')
    call expect(next(limits, 1, taken(8, 1, 1.5_wp, retries=1, dt=0.5_wp), 0) == 1, 'a repeated step within it stays')
    ! the last step of a run may be cut: its Courant number is that of its own length
    call expect(next(limits, 0, taken(8, 1, 0.5_wp, dt=0.1_wp)) == 2, 'a cut step is judged by its own length')
  end subroutine by_courant

  subroutine by_iterations()
    type(step_limits_t) :: limits

    limits = step_limits_t(1.0_wp, 2, target_iterations=20)
    call expect(next(limits, 0, taken(8, 20, 1.0e3_wp)) == 0, 'as many iterations as aimed at')
    call expect(next(limits, 0, taken(8, 21, 0.0_wp)) == 1, 'one more halves the step')
    call expect(next(limits, 1, taken(8, 21, 0.0_wp, retries=1)) == 2, 'a repeated one, too')
    call expect(next(limits, 2, taken(8, 21, 0.0_wp), 9) == 2, 'no further than the shortest, and no way back')
    call expect(next(limits, 2, taken(8, 20, 0.0_wp), 9) == 1, 'the tenth good step doubles it')
    call expect(next(limits, 2, taken(8, 20, 0.0_wp), 8) == 2, 'the ninth does not')
    limits%maximum_courant = 1.0_wp
    call expect(next(limits, 0, taken(8, 21, 3.0_wp)) == 2, 'the stricter of two limits')
  end subroutine by_iterations

  !> Where steps adapt they are doubled where a step of twice the length could have ended.
  subroutine keep_the_beat()
    type(step_limits_t) :: limits

    limits = step_limits_t(0.3_wp, 6, maximum_courant=1.0_wp)
    call expect(next(limits, 1, step_taken_t(time=0.9_wp, dt=0.15_wp), 9) == 0, 'doubled at a multiple of twice the step')
    call expect(next(limits, 1, step_taken_t(time=0.75_wp, dt=0.15_wp), 9) == 1, 'not between two of them')
    call expect(next(limits, 1, step_taken_t(time=0.9_wp, dt=0.15_wp), 12) == 0, 'and later as well')
  end subroutine keep_the_beat

  !> Halvings of the step after one of so many.
  pure function next(limits, halvings, last, good_steps)
    type(step_limits_t), intent(in) :: limits
    integer, intent(in) :: halvings
    type(step_taken_t), intent(in) :: last
    integer, intent(in), optional :: good_steps
    integer :: next

    integer :: good

    next = halvings
    good = 0
    if (present(good_steps)) good = good_steps
    call plan_step(limits, last, next, good)
  end function next

  !> A step that ended at a whole number of longest steps of 1 s, unless told otherwise of 1 s itself.
  pure function taken(time, iterations, courant, retries, dt) result(step)
    integer, intent(in) :: time, iterations
    real(wp), intent(in) :: courant
    integer, intent(in), optional :: retries
    real(wp), intent(in), optional :: dt
    type(step_taken_t) :: step

    step = step_taken_t(real(time, wp), 1.0_wp, 0, iterations, courant)
    if (present(retries)) step%retries = retries
    if (present(dt)) step%dt = dt
  end function taken

end program test_step_control
