!> The first failure of an outcome stands.
program test_outcome
  use check, only: expect, finish
  use outcome, only: outcome_t, exit_failed, exit_environment
  implicit none

  type(outcome_t) :: result

  call expect(.not. result%failed(), 'an outcome starts well')
  call result%fail(exit_failed, 'first')
  call result%fail(exit_environment, 'second')
  call expect(result%failed() .and. result%message == 'first', 'the first failure stands')
  call finish()
end program test_outcome
