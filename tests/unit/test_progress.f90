!> What is shown of a run in progress.
program test_progress
  use check, only: expect, finish
  use kinds, only: wp, i8
  use progress, only: progress_t, duration, bar_text, line_text
  implicit none

  type(progress_t) :: progress

  call expect(duration(0.0_wp) == '0:00', 'no time')
  call expect(duration(59.6_wp) == '1:00', 'seconds are rounded')
  call expect(duration(750.0_wp) == '12:30', 'minutes')
  call expect(duration(100000.0_wp) == '27:46:40', 'hours')
  call expect(duration(-1.0_wp) == '?', 'unknown')
  call expect(bar_text(0.6_wp, 2.0_wp, 750.0_wp) == &
              '[#######-----------------]  30 %    0.6000 of 2.00000 s   12:30 left', 'a bar')
  call expect(line_text(0.6_wp, 2.0_wp, 1.0e-3_wp, 5, 20345_i8, 750.0_wp) == &
              't =   0.600000 s  30 %   dt 1.00E-03 s    5 iterations     20345 parcels   12:30 left', 'a line')
  call expect(line_text(0.6_wp, 2.0_wp, 1.0e-3_wp, 0, 0_i8, -1.0_wp) == &
              't =   0.600000 s  30 %   dt 1.00E-03 s   ? left', 'a line without gas and parcels')
  call progress%start('none', .true., 0.0_wp, 1.0_wp)
  call progress%update(0.5_wp, 1.0e-3_wp, 1, 1_i8)
  call progress%finish(1.0_wp)
  call progress%say('a line of the log')
  call finish()
end program test_progress
