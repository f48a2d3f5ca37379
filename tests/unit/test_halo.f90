!> Halos hold the cells of the neighbours, edges and corners included, and nothing else is touched.
program test_halo
  use boxes, only: boxes_t, new_boxes
  use check, only: expect, expect_all, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use halo, only: halo_t, new_halo
  use kinds, only: wp
  use outcome, only: outcome_t
  implicit none

  real(wp), parameter :: untouched = -7.0_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  call compare([12, 8, 10], [.false., .false., .false.], 'closed')
  call compare([9, 7, 5], [.true., .true., .true.], 'periodic, odd')
  call compare([8, 9, 1], [.true., .false., .true.], 'one periodic cell thick')
  call compare([1, 8, 3], [.true., .true., .false.], 'one periodic cell wide')
  call compare([4, 4, 2], [.true., .true., .true.], 'two cells each way')
  call conserve([10, 6, 12])
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Fields that number the cells of the whole grid, exchanged, against the numbers that belong there.
  subroutine compare(n, periodic, name)
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    character(len=*), intent(in) :: name

    type(boxes_t) :: boxes
    type(halo_t) :: halo
    type(outcome_t) :: outcome
    real(wp), allocatable :: f(:,:,:,:)
    integer :: m
    logical :: right

    call new_boxes(comm, n, periodic, boxes, outcome)
    halo = new_halo(boxes)
    associate (b => boxes%n)
      allocate (f(-1:b(1) + 2, -1:b(2) + 2, -1:b(3) + 2, 6), source=untouched)
      do m = 1, 6
        call number_cells(boxes, m, f(:,:,:, m))
      end do
    end associate
    call halo%exchange(f(:,:,:, 1))
    right = as_expected(boxes, 1, f(:,:,:, 1)) .and. .not. outcome%failed()
    call expect_all(right, name//': the halo of one field')
    call halo%exchange_many(f)
    right = .true.
    do m = 1, 6
      right = right .and. as_expected(boxes, m, f(:,:,:, m))
    end do
    call expect_all(right, name//': the halos of six fields')
  end subroutine compare

  pure subroutine number_cells(boxes, m, f)
    type(boxes_t), intent(in) :: boxes
    integer, intent(in) :: m
    real(wp), intent(inout) :: f(-1:, -1:, -1:)

    integer :: i, j, k

    do k = 1, boxes%n(3)
      do j = 1, boxes%n(2)
        do i = 1, boxes%n(1)
          f(i, j, k) = number(boxes, m, boxes%lo - 1 + [i, j, k])
        end do
      end do
    end do
  end subroutine number_cells

  !> The number of a cell of the whole grid in field m; beyond a closed face there is none.
  pure function number(boxes, m, cell)
    type(boxes_t), intent(in) :: boxes
    integer, intent(in) :: m, cell(3)
    real(wp) :: number

    integer :: c(3)

    c = merge(1 + modulo(cell - 1, boxes%cells), cell, boxes%periodic)
    number = untouched
    if (all(c >= 1 .and. c <= boxes%cells)) number = m + 10*c(1) + 1e3_wp*c(2) + 1e5_wp*c(3)
  end function number

  pure function as_expected(boxes, m, f)
    type(boxes_t), intent(in) :: boxes
    integer, intent(in) :: m
    real(wp), intent(in) :: f(-1:, -1:, -1:)
    logical :: as_expected

    integer :: i, j, k

    as_expected = .true.
    do k = -1, boxes%n(3) + 2
      do j = -1, boxes%n(2) + 2
        do i = -1, boxes%n(1) + 2
          as_expected = as_expected .and. abs(f(i, j, k) - number(boxes, m, boxes%lo - 1 + [i, j, k])) < 0.5_wp
        end do
      end do
    end do
  end function as_expected

  !> What crosses the faces of a periodic grid leaves one cell and enters another: the sum stays.
  subroutine conserve(n)
    integer, intent(in) :: n(3)

    type(boxes_t) :: boxes
    type(halo_t) :: halo
    type(outcome_t) :: outcome
    real(wp), allocatable :: f(:,:,:)
    real(wp) :: before, after

    call new_boxes(comm, n, [.true., .true., .true.], boxes, outcome)
    halo = new_halo(boxes)
    associate (b => boxes%n)
      allocate (f(-1:b(1) + 2, -1:b(2) + 2, -1:b(3) + 2), source=0.0_wp)
      call number_cells(boxes, 1, f)
      f = sin(f)
      before = comm%sum(sum(f(1:b(1), 1:b(2), 1:b(3))**2))
      call halo%exchange(f)
      after = comm%sum(sum(f(-1:b(1) - 2, 3:b(2) + 2, 0:b(3) - 1)**2))
    end associate
    if (comm%is_root()) call expect(before > 1.0_wp, 'there is something to conserve')
    call close_to(after, before, 'a shift through the halos keeps the sum')
  end subroutine conserve

  subroutine close_to(value, expected, name)
    real(wp), intent(in) :: value, expected
    character(len=*), intent(in) :: name

    if (comm%is_root()) call expect_close(value, expected, 1e-13_wp, name)
  end subroutine close_to

end program test_halo
