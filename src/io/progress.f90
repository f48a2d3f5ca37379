!> What a person sees of a run: a bar on a terminal, a line now and then in a batch file, or nothing.
!>
!> The root alone prints. `say` is for everything else that is told during a run: it does not tear the bar.
module progress
  use, intrinsic :: iso_fortran_env, only: output_unit
  use files, only: is_terminal
  use kinds, only: wp, i8
  use timing, only: wall_seconds
  implicit none
  private
  public :: progress_t, duration, bar_text, line_text

  integer, parameter :: no_progress = 0, in_lines = 1, as_bar = 2
  integer, parameter :: bar_width = 24                !< characters
  real(wp), parameter :: between_bars = 0.2_wp        !< at least, of wall time [s]
  real(wp), parameter :: between_lines = 5.0_wp       !< at least [s]
  real(wp), parameter :: part_of_run = 0.02_wp        !< lines come apart as the run grows old: this part of its age,
  real(wp), parameter :: longest_silence = 600.0_wp   !< but at most so long [s]
  real(wp), parameter :: memory = 30.0_wp             !< of the speed from which the remaining time is told [s]

  type :: progress_t
    private
    integer :: form = no_progress
    logical :: bar_shown = .false.    !< the cursor stands behind a bar
    real(wp) :: end_time = 0.0_wp     !< of the run [s], simulated
    real(wp) :: begun = 0.0_wp        !< wall clock [s]
    real(wp) :: shown = 0.0_wp        !< wall clock when something was last shown [s]
    real(wp) :: looked = 0.0_wp       !< wall clock and simulated time at the last update [s]
    real(wp) :: time = 0.0_wp
    real(wp) :: speed = 0.0_wp        !< simulated over wall time, lately
  contains
    procedure :: start
    procedure :: update
    procedure :: say
    procedure :: finish
  end type progress_t

contains

  !> Begin at the simulated time `time`.
  subroutine start(self, form, is_root, time, end_time)
    class(progress_t), intent(out) :: self
    character(len=*), intent(in) :: form     !< 'bar' (lines where there is no terminal), 'lines' or 'none'
    logical, intent(in) :: is_root
    real(wp), intent(in) :: time, end_time   !< [s]

    if (form == 'lines') self%form = in_lines
    if (form == 'bar') self%form = merge(as_bar, in_lines, is_terminal())
    if (.not. is_root) self%form = no_progress
    self%end_time = end_time
    self%time = time
    self%begun = wall_seconds()
    self%looked = self%begun
    self%shown = self%begun
  end subroutine start

  !> To be called after every step; shows something only if it is time to.
  subroutine update(self, time, dt, iterations, parcels)
    class(progress_t), intent(inout) :: self
    real(wp), intent(in) :: time          !< simulated [s]
    real(wp), intent(in) :: dt            !< of the gas, or of the parcels without gas [s]
    integer, intent(in) :: iterations     !< of the gas in the last step; 0: none to show
    integer(i8), intent(in) :: parcels    !< on all ranks; 0: none to show

    real(wp) :: now, silence
    character(len=:), allocatable :: text

    if (self%form == no_progress) return
    now = wall_seconds()
    silence = between_bars
    if (self%form == in_lines) silence = min(max(between_lines, part_of_run*(now - self%begun)), longest_silence)
    if (now - self%shown < silence) return
    call gauge_speed(self, time, now)
    if (self%form == as_bar) then
      text = bar_text(time, self%end_time, remaining(self, time))
      write (output_unit, '(4a)', advance='no') achar(13), text, achar(27), '[K'
      flush (output_unit)
      self%bar_shown = .true.
    else
      call self%say(line_text(time, self%end_time, dt, iterations, parcels, remaining(self, time)))
    end if
    self%shown = now
  end subroutine update

  !> The speed of late: a mean that forgets, so a run that becomes slower is believed soon.
  subroutine gauge_speed(self, time, now)
    type(progress_t), intent(inout) :: self
    real(wp), intent(in) :: time, now  !< simulated and wall [s]

    real(wp) :: share, speed, wall

    wall = now - self%looked
    speed = (time - self%time)/max(wall, 1.0e-9_wp)
    share = 1 - exp(-wall/memory)
    if (self%speed <= 0.0_wp) share = 1.0_wp
    self%speed = self%speed + share*(speed - self%speed)
    self%looked = now
    self%time = time
  end subroutine gauge_speed

  !> Wall time to the end [s], negative if it cannot be told.
  pure function remaining(self, time) result(seconds)
    type(progress_t), intent(in) :: self
    real(wp), intent(in) :: time
    real(wp) :: seconds

    seconds = -1.0_wp
    if (self%speed > 0.0_wp) seconds = (self%end_time - time)/self%speed
  end function remaining

  !> Such as '[#######-----------------]  30 %   0.6000 of 2 s   12:30 left'.
  pure function bar_text(time, end_time, left) result(text)
    real(wp), intent(in) :: time, end_time  !< [s]
    real(wp), intent(in) :: left            !< wall time to the end [s]
    character(len=:), allocatable :: text

    real(wp) :: part
    integer :: filled
    character(len=40) :: numbers

    part = min(max(time/end_time, 0.0_wp), 1.0_wp)
    filled = int(part*bar_width)
    write (numbers, '(i4,a,f10.4,a,g0.6)') int(100*part), ' %', time, ' of ', end_time
    text = '['//repeat('#', filled)//repeat('-', bar_width - filled)//']'//trim(numbers)//' s   '//duration(left)//' left'
  end function bar_text

  !> Such as 't =  0.600000 s   30 %   dt 1.00E-03 s    5 iterations    20345 parcels   12:30 left'.
  pure function line_text(time, end_time, dt, iterations, parcels, left) result(text)
    real(wp), intent(in) :: time, end_time, dt  !< [s]
    integer, intent(in) :: iterations
    integer(i8), intent(in) :: parcels
    real(wp), intent(in) :: left                !< wall time to the end [s]
    character(len=:), allocatable :: text

    character(len=60) :: part

    write (part, '(a,f10.6,a,i4,a,es9.2,a)') 't = ', time, ' s', int(100*time/end_time), ' %   dt', dt, ' s'
    text = trim(part)
    write (part, '(i5,a)') iterations, ' iterations'
    if (iterations > 0) text = text//trim(part)
    write (part, '(i10,a)') parcels, ' parcels'
    if (parcels > 0) text = text//trim(part)
    text = text//'   '//duration(left)//' left'
  end function line_text

  !> A wall time as hours:minutes:seconds; '?' if it is negative.
  pure function duration(seconds) result(text)
    real(wp), intent(in) :: seconds
    character(len=:), allocatable :: text

    character(len=24) :: figures
    integer(i8) :: whole

    text = '?'
    if (seconds < 0.0_wp .or. seconds > 1.0e12_wp) return
    whole = nint(seconds, i8)
    if (whole >= 3600) then
      write (figures, '(i0,2(":",i2.2))') whole/3600, modulo(whole/60, 60_i8), modulo(whole, 60_i8)
    else
      write (figures, '(i0,":",i2.2)') whole/60, modulo(whole, 60_i8)
    end if
    text = trim(figures)
  end function duration

  !> Print a line of text, whatever the form of progress. For the root.
  subroutine say(self, text)
    class(progress_t), intent(inout) :: self
    character(len=*), intent(in) :: text

    if (self%bar_shown) write (output_unit, '(3a)', advance='no') achar(13), achar(27), '[K'
    self%bar_shown = .false.
    write (output_unit, '(a)') text
    flush (output_unit)
  end subroutine say

  !> Leave the last bar on the screen, at the time reached.
  subroutine finish(self, time)
    class(progress_t), intent(inout) :: self
    real(wp), intent(in) :: time  !< simulated [s]

    if (self%form /= as_bar) return
    write (output_unit, '(4a)') achar(13), bar_text(time, self%end_time, 0.0_wp), achar(27), '[K'
    flush (output_unit)
    self%bar_shown = .false.
  end subroutine finish

end module progress
