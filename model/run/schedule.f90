!> When something recurs in simulated time.
module schedule
  use constants, only: is_set
  use kinds, only: wp, i8
  implicit none
  private
  public :: schedule_t, new_schedule

  real(wp), parameter :: slack = 1.0e-6_wp  !< of an interval: a time that misses by less is on time

  !> At 0, interval, 2 interval ... Nothing but the time decides, so a run that is continued keeps the beat.
  type :: schedule_t
    private
    real(wp) :: interval = 0   !< [s]; 0: never
    integer(i8) :: next = 0    !< beat that has not been yet
  contains
    procedure :: recurs
    procedure :: is_due
    procedure :: done
  end type schedule_t

contains

  !> A schedule from a key of the case; unset is never.
  pure function new_schedule(interval, start) result(schedule)
    real(wp), intent(in) :: interval             !< [s] or unset
    real(wp), intent(in), optional :: start      !< of a continued run: what was due until then has been done [s]
    type(schedule_t) :: schedule

    if (is_set(interval)) schedule%interval = interval
    if (present(start)) call schedule%done(start)
  end function new_schedule

  !> Whether it ever comes.
  pure function recurs(self)
    class(schedule_t), intent(in) :: self
    logical :: recurs

    recurs = self%interval > 0
  end function recurs

  pure function is_due(self, time)
    class(schedule_t), intent(in) :: self
    real(wp), intent(in) :: time  !< [s]
    logical :: is_due

    is_due = .false.
    if (self%interval > 0) is_due = time/self%interval >= self%next - slack
  end function is_due

  !> What is due at this time has been done.
  pure subroutine done(self, time)
    class(schedule_t), intent(inout) :: self
    real(wp), intent(in) :: time  !< [s]

    if (self%interval > 0) self%next = int(time/self%interval + slack, i8) + 1
  end subroutine done

end module schedule
