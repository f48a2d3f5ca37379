!> How a piece of work ended: well, or with a message and the exit code it asks for.
module outcome
  implicit none
  private
  public :: outcome_t, exit_done, exit_input, exit_failed, exit_environment, exit_stopped

  integer, parameter :: exit_done = 0         !< the run did what was asked
  integer, parameter :: exit_input = 2        !< a mistake of the user; nothing was written
  integer, parameter :: exit_failed = 3       !< the run failed; the last good state was written
  integer, parameter :: exit_environment = 4  !< a file, a library or the machine
  integer, parameter :: exit_stopped = 85     !< stopped on request, with a checkpoint to resume from

  type :: outcome_t
    integer :: code = exit_done
    character(len=:), allocatable :: message
  contains
    procedure :: failed
    procedure :: fail
  end type outcome_t

contains

  !> Whether anything went wrong.
  pure function failed(self)
    class(outcome_t), intent(in) :: self
    logical :: failed

    failed = self%code /= exit_done
  end function failed

  !> Record a failure; the first one stands.
  pure subroutine fail(self, code, message)
    class(outcome_t), intent(inout) :: self
    integer, intent(in) :: code
    character(len=*), intent(in) :: message

    if (self%failed()) return
    self%code = code
    self%message = message
  end subroutine fail

end module outcome
