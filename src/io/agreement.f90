!> All ranks come to know that one of them failed, and why.
module agreement
  use communicator, only: communicator_t
  use kinds, only: wp
  use outcome, only: outcome_t
  implicit none
  private
  public :: agree

  integer, parameter :: longest = 400  !< characters of a message that travel

contains

  !> After this, the outcome is the same on all ranks: that of the lowest rank that failed, if any did.
  subroutine agree(comm, outcome)
    type(communicator_t), intent(in) :: comm
    type(outcome_t), intent(inout) :: outcome

    integer :: first, i
    real(wp) :: letters(0:longest)
    character(len=longest) :: message

    first = -comm%max(merge(-comm%rank, -comm%size, outcome%failed()))
    if (first == comm%size) return
    ! Only one rank contributes to the sum, so the sum is its message.
    letters = 0.0_wp
    if (comm%rank == first) then
      message = outcome%message
      letters = real([outcome%code, (ichar(message(i:i)), i=1, longest)], wp)
    end if
    letters = comm%sum(letters)
    do i = 1, longest
      message(i:i) = char(nint(letters(i)))
    end do
    outcome%code = nint(letters(0))
    outcome%message = trim(message)
  end subroutine agree

end module agreement
