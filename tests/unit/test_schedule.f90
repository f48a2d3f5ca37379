!> Beats of a schedule, at the start and in a run that is continued.
program test_schedule
  use check, only: expect, finish
  use constants, only: unset
  use kinds, only: wp
  use schedule, only: schedule_t, new_schedule
  implicit none

  type(schedule_t) :: every, never
  integer :: step, beats

  every = new_schedule(0.02_wp)
  never = new_schedule(unset)
  beats = 0
  do step = 0, 100
    if (every%is_due(step*1.0e-3_wp)) then
      beats = beats + 1
      call every%done(step*1.0e-3_wp)
    end if
  end do
  call expect(beats == 6, 'six beats of 0.02 s from 0 to 0.1 s')
  call expect(.not. never%is_due(1.0_wp), 'an interval that is unset never comes')
  every = new_schedule(0.02_wp, start=0.04_wp)
  call expect(.not. every%is_due(0.059_wp) .and. every%is_due(0.06_wp), 'a continued run keeps the beat')
  call finish()
end program test_schedule
