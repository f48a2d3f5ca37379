!> A stopwatch charges each part for its own time only, and loses none.
program test_timing
  use check, only: expect, expect_close, finish
  use kinds, only: wp
  use timing, only: stopwatch_t, wall_seconds
  implicit none

  type(stopwatch_t) :: watch
  real(wp) :: begun, time(3)
  character(len=24) :: names(3)
  integer :: i

  begun = wall_seconds()
  call watch%start(['outer', 'inner'])
  call watch%enter(1)
  call wait(0.05_wp)
  call watch%enter(2)
  call wait(0.1_wp)
  call watch%leave()
  call wait(0.05_wp)
  call watch%leave()
  call wait(0.02_wp)
  time = watch%seconds()
  names = watch%part_names()
  call expect(all(names == [character(len=24) :: 'outer', 'inner', 'other']), 'parts come by name, other last')
  ! On a busy machine a wait is longer than asked for, never shorter.
  call expect(time(1) > 0.0999_wp, 'an outer part has its time')
  call expect(time(2) > 0.0999_wp, 'an inner part has its time')
  call expect(time(3) > 0.0199_wp, 'what belongs to no part has the rest')
  call expect_close(sum(time), wall_seconds() - begun, 0.05_wp, 'no time is counted twice or lost')
  begun = wall_seconds()
  do i = 1, 100000
    call watch%enter(1)
    call watch%leave()
  end do
  call expect((wall_seconds() - begun)/1.0e5_wp < 2.0e-6_wp, 'entering and leaving costs less than 2 microseconds')
  call finish()

contains

  subroutine wait(seconds)
    real(wp), intent(in) :: seconds

    real(wp) :: from

    from = wall_seconds()
    do while (wall_seconds() - from < seconds)
    end do
  end subroutine wait

end program test_timing
