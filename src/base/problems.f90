!> The mistakes found in what a user gave. None ends the program before the last is known.
module problems
  use text, only: string_t
  implicit none
  private
  public :: problems_t

  type :: problems_t
    private
    type(string_t), allocatable :: messages(:)  !< room for more than there are
    integer :: found = 0
  contains
    procedure :: add
    procedure :: require
    procedure :: count => number_found
    procedure :: message
    procedure :: print => print_all
  end type problems_t

contains

  !> Note one mistake.
  pure subroutine add(self, message)
    class(problems_t), intent(inout) :: self
    character(len=*), intent(in) :: message

    type(string_t), allocatable :: longer(:)

    if (.not. allocated(self%messages)) allocate (self%messages(16))
    if (self%found == size(self%messages)) then
      allocate (longer(2*self%found))
      longer(:self%found) = self%messages
      call move_alloc(longer, self%messages)
    end if
    self%found = self%found + 1
    self%messages(self%found)%text = message
  end subroutine add

  !> Note a mistake unless `ok`.
  pure subroutine require(self, ok, message)
    class(problems_t), intent(inout) :: self
    logical, intent(in) :: ok
    character(len=*), intent(in) :: message

    if (.not. ok) call self%add(message)
  end subroutine require

  pure function number_found(self) result(count)
    class(problems_t), intent(in) :: self
    integer :: count

    count = self%found
  end function number_found

  !> The i-th mistake.
  pure function message(self, i)
    class(problems_t), intent(in) :: self
    integer, intent(in) :: i  !< from 1 to count()
    character(len=:), allocatable :: message

    message = self%messages(i)%text
  end function message

  !> All of them, one per line, and their number.
  subroutine print_all(self, unit)
    class(problems_t), intent(in) :: self
    integer, intent(in) :: unit

    integer :: i

    do i = 1, self%found
      write (unit, '(a)') self%messages(i)%text
    end do
    if (self%found == 1) write (unit, '(a)') '1 mistake; nothing was computed or written'
    if (self%found > 1) write (unit, '(i0,a)') self%found, ' mistakes; nothing was computed or written'
  end subroutine print_all

end module problems
