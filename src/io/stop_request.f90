!> Whether somebody or something wants the run to end before its time: a signal, a file named `stop` in the results
!> folder, or the limit on the wall clock.
module stop_request
  use communicator, only: communicator_t
  use constants, only: is_set
  use files, only: exists, remove_file
  use kinds, only: wp
  use signals, only: caught_signal, signal_name
  use timing, only: wall_seconds
  implicit none
  private
  public :: stop_request_t

  integer, parameter :: by_file = 1000, by_clock = 1001  !< reasons, beside the numbers of signals
  real(wp), parameter :: between_looks = 0.5_wp           !< at the folder, of wall time [s]

  type :: stop_request_t
    private
    character(len=:), allocatable :: file
    real(wp) :: limit = huge(1.0_wp)  !< of the wall clock [s]
    real(wp) :: looked = 0.0_wp       !< wall clock when the folder was last looked at [s]
    integer :: code = 0               !< of the reason; 0: no request
  contains
    procedure :: start
    procedure :: is_made
    procedure :: reason => reason_of
  end type stop_request_t

contains

  !> From now on the wall clock counts; a stop file that is there already is from before and removed.
  subroutine start(self, comm, folder, wall_clock_limit)
    class(stop_request_t), intent(out) :: self
    type(communicator_t), intent(in) :: comm
    character(len=*), intent(in) :: folder            !< of the results
    real(wp), intent(in) :: wall_clock_limit          !< [s] or unset

    self%file = folder//'/stop'
    self%looked = wall_seconds()
    if (is_set(wall_clock_limit)) self%limit = self%looked + wall_clock_limit
    if (comm%is_root()) call remove_file(self%file)
  end subroutine start

  !> To be asked by all ranks together after every step: they get the same answer. A stop file is used up by it.
  function is_made(self, comm)
    class(stop_request_t), intent(inout) :: self
    type(communicator_t), intent(in) :: comm
    logical :: is_made

    real(wp) :: now
    integer :: mine

    mine = caught_signal()
    if (comm%is_root()) then
      now = wall_seconds()
      if (now > self%limit) mine = by_clock
      if (now - self%looked > between_looks) then
        self%looked = now
        if (exists(self%file)) mine = by_file
      end if
      if (mine == by_file) call remove_file(self%file)
    end if
    self%code = comm%max(mine)
    is_made = self%code > 0
  end function is_made

  !> Why the run ends, for the log.
  function reason_of(self) result(text)
    class(stop_request_t), intent(in) :: self
    character(len=:), allocatable :: text

    select case (self%code)
    case (0)
      text = 'not at all'
    case (by_file)
      text = "the file '"//self%file//"'"
    case (by_clock)
      text = 'the wall clock limit'
    case default
      text = 'signal '//signal_name(self%code)
    end select
  end function reason_of

end module stop_request
