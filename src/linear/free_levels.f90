!> Where nothing gives the pressure of the gas its level: in all of it, or in parts that walls keep from each other.
!>
!> The equations of such a part hold for any level and only if their right-hand sides add up to nothing. One cell of the part
!> keeps its pressure, and the mean of the right-hand sides is left out.
module free_levels
  use boxes, only: boxes_t
  use communicator, only: communicator_t
  use kinds, only: wp
  implicit none
  private
  public :: free_levels_t, one_level

  type :: free_levels_t
    integer :: n = 0                       !< parts without a level
    integer, allocatable :: cell(:,:)      !< (3,n) the cell of each that keeps its pressure, counted in my box, or outside it
    real(wp), allocatable :: cells(:)      !< (n) that are open in each, of the whole grid
    integer, allocatable :: part(:,:,:)    !< (n1,n2,n3) of each cell, 0 of closed ones; exists if there are several
  contains
    procedure :: is_mine
    procedure :: leave_out_means
    procedure :: keep_levels
  end type free_levels_t

contains

  !> All of the gas as one part, no cell closed.
  pure function one_level(boxes) result(levels)
    type(boxes_t), intent(in) :: boxes
    type(free_levels_t) :: levels

    levels%n = 1
    allocate (levels%cell(3, 1), levels%cells(1))
    levels%cell(:, 1) = 2 - boxes%lo
    levels%cells(1) = product(real(boxes%cells, wp))
  end function one_level

  !> Whether the cell that keeps the pressure of a part is in my box.
  pure function is_mine(self, p, n)
    class(free_levels_t), intent(in) :: self
    integer, intent(in) :: p, n(3)  !< part; cells of my box
    logical :: is_mine

    is_mine = all(self%cell(:, p) >= 1 .and. self%cell(:, p) <= n)
  end function is_mine

  !> Take out of the right-hand sides what no pressure can satisfy.
  subroutine leave_out_means(self, comm, b)
    class(free_levels_t), intent(in) :: self
    type(communicator_t), intent(in) :: comm
    real(wp), intent(inout) :: b(:,:,:)  !< (n1,n2,n3)

    real(wp) :: means(self%n)
    integer :: p

    if (.not. allocated(self%part)) then
      b = b - comm%sum(sum(b))/self%cells(1)
      return
    end if
    means = comm%sum([(sum(b, self%part == p), p=1, self%n)])/self%cells
    do p = 1, self%n
      where (self%part == p) b = b - means(p)
    end do
  end subroutine leave_out_means

  !> Move a correction of the pressure so that the cells that keep theirs are left alone.
  subroutine keep_levels(self, comm, correction)
    class(free_levels_t), intent(in) :: self
    type(communicator_t), intent(in) :: comm
    real(wp), intent(inout) :: correction(:,:,:)  !< (n1,n2,n3) [Pa]

    real(wp) :: levels(self%n)
    integer :: p

    levels = 0.0_wp
    do p = 1, self%n
      associate (c => self%cell(:, p))
        if (self%is_mine(p, shape(correction))) levels(p) = correction(c(1), c(2), c(3))
      end associate
    end do
    levels = comm%sum(levels)
    if (.not. allocated(self%part)) correction = correction - levels(1)
    if (.not. allocated(self%part)) return
    do p = 1, self%n
      where (self%part == p) correction = correction - levels(p)
    end do
  end subroutine keep_levels

end module free_levels
