!> Wall time of a run, split by the part of the program that spends it.
module timing
  use kinds, only: wp, i8
  implicit none
  private
  public :: stopwatch_t, wall_seconds, print_times, name_length

  integer, parameter :: name_length = 24
  integer, parameter :: deepest = 16       !< parts inside parts

  !> Parts may lie inside one another. Each is charged only for the time not spent in an inner one, so the parts
  !> and `other` (part 0: no part at all) add up to the whole. One enter or leave costs about 30 ns.
  type :: stopwatch_t
    private
    character(len=name_length), allocatable :: names(:)  !< (0:parts)
    integer(i8), allocatable :: ticks(:)                 !< (0:parts) clock ticks so far
    integer(i8) :: mark = 0                              !< the clock at the last enter or leave
    integer :: stack(0:deepest) = 0                      !< the parts we are in, outermost first
    integer :: depth = 0
  contains
    procedure :: start
    procedure :: enter
    procedure :: leave
    procedure :: seconds
    procedure :: part_names
  end type stopwatch_t

contains

  !> Begin to measure. Part i of enter(i) is the i-th name.
  subroutine start(self, names)
    class(stopwatch_t), intent(out) :: self
    character(len=*), intent(in) :: names(:)

    allocate (self%names(0:size(names)))
    allocate (self%ticks(0:size(names)), source=0_i8)
    self%names(0) = 'other'
    self%names(1:) = names
    call system_clock(self%mark)
  end subroutine start

  subroutine enter(self, part)
    class(stopwatch_t), intent(inout) :: self
    integer, intent(in) :: part  !< 1 to the number of parts

    call charge(self)
    if (self%depth == deepest) error stop 'timing: more parts inside parts than `deepest`'
    self%depth = self%depth + 1
    self%stack(self%depth) = part
  end subroutine enter

  !> Leave the part entered last.
  subroutine leave(self)
    class(stopwatch_t), intent(inout) :: self

    call charge(self)
    if (self%depth == 0) error stop 'timing: leave without enter'
    self%depth = self%depth - 1
  end subroutine leave

  !> Add the time since the last change to the part we are in.
  subroutine charge(self)
    class(stopwatch_t), intent(inout) :: self

    integer(i8) :: now

    call system_clock(now)
    associate (part => self%stack(self%depth))
      self%ticks(part) = self%ticks(part) + now - self%mark
    end associate
    self%mark = now
  end subroutine charge

  !> Time of each part up to now [s], the last one `other`; their sum is the time since start.
  function seconds(self) result(time)
    class(stopwatch_t), intent(inout) :: self
    real(wp) :: time(size(self%ticks))

    integer(i8) :: rate

    call charge(self)
    call system_clock(count_rate=rate)
    time = real(cshift(self%ticks, 1), wp)/real(rate, wp)
  end function seconds

  !> Names in the order of `seconds`.
  pure function part_names(self) result(names)
    class(stopwatch_t), intent(in) :: self
    character(len=name_length) :: names(size(self%names))

    names = cshift(self%names, 1)
  end function part_names

  !> Wall clock [s] from an arbitrary origin.
  function wall_seconds() result(time)
    real(wp) :: time

    integer(i8) :: ticks, rate

    call system_clock(ticks, rate)
    time = real(ticks, wp)/real(rate, wp)
  end function wall_seconds

  !> The table of wall time by part: the mean over the ranks, its share of the whole, the least and the most.
  subroutine print_times(unit, names, least, mean, most)
    integer, intent(in) :: unit
    character(len=*), intent(in) :: names(:)
    real(wp), intent(in) :: least(:), mean(:), most(:)  !< over the ranks [s]

    integer :: i

    write (unit, '(2x,a24,4a12)') 'wall time               ', 'mean s', 'share', 'least s', 'most s'
    do i = 1, size(names)
      if (most(i) <= 0.0_wp) cycle
      write (unit, '(2x,a24,f12.2,f10.1,a,2f12.2)') &
        names(i), mean(i), 100*mean(i)/sum(mean), ' %', least(i), most(i)
    end do
    write (unit, '(2x,a24,f12.2)') 'all                     ', sum(mean)
  end subroutine print_times

end module timing
