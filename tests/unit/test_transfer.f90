!> Cells carried from boxes to windows and back, for scattered windows, on any number of ranks.
program test_transfer
  use boxes, only: boxes_t, new_boxes
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use kinds, only: wp
  use outcome, only: outcome_t
  use transfer, only: transfer_t, new_transfer
  use window, only: window_t, new_window
  implicit none

  integer, parameter :: pieces(3) = [3, 4, 2]    ! regions the domain is cut into, dealt to the ranks in turn
  type(communicator_t) :: comm

  call start_ranks(comm)
  call check_window()
  call check_transfer([8, 12, 6], [.false., .false., .false.], 'walls')
  call check_transfer([9, 10, 6], [.true., .false., .true.], 'periodic in x and z')
  call check_transfer([12, 24, 1], [.true., .true., .false.], 'one cell thick')
  call check_transfer([16, 8, 1], [.true., .true., .true.], 'one cell thick and periodic')
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> The eight cells around a parcel in the corner of a region.
  subroutine check_window()
    type(window_t) :: window
    real(wp) :: corners(3, 2, 1)

    if (.not. comm%is_root()) return
    corners(:, 1, 1) = [-0.1_wp, 2.1_wp, -0.1_wp]
    corners(:, 2, 1) = [2.1_wp, 4.1_wp, 10.1_wp]
    window = new_window([10, 10, 10], [.true., .false., .false.], corners)
    call expect(all(window%lo == [0, 2, 1]), 'a window begins one centre below, or at the wall')
    call expect(all(window%hi == [3, 5, 10]), 'a window ends one centre above, or at the wall')
    call expect(all(window%cell_at(1) == [10, 2, 1]), 'the first cell of a periodic window is an image')
    call expect(all(window%cell_at(4*4*3 + 4*2 + 4) == [3, 4, 4]), 'cells are counted with x fastest')
    window = new_window([10, 10, 10], [.true., .false., .false.], corners(:, :, 1:0))
    call expect(window%cells() == 0, 'no region, no window')
  end subroutine check_window

  !> Corners of the regions of one rank, over the size of the domain.
  function regions(rank) result(corners)
    integer, intent(in) :: rank
    real(wp), allocatable :: corners(:,:,:)

    integer :: i, j, k, m
    real(wp) :: edge(3)

    edge = 1.0_wp/pieces
    allocate (corners(3, 2, 0))
    m = 0
    do k = 0, pieces(3) - 1
      do j = 0, pieces(2) - 1
        do i = 0, pieces(1) - 1
          m = m + 1
          if (modulo(5*m + m/7, comm%size) /= rank) cycle
          corners = reshape([corners, edge*[i, j, k], edge*[i + 1, j + 1, k + 1]], &
                            [3, 2, size(corners, 3) + 1])
        end do
      end do
    end do
  end function regions

  function window_of(rank, n, periodic) result(window)
    integer, intent(in) :: rank, n(3)
    logical, intent(in) :: periodic(3)
    type(window_t) :: window

    real(wp), allocatable :: corners(:,:,:)
    integer :: a

    allocate (corners, source=regions(rank))
    do a = 1, 3
      corners(a, 1, :) = n(a)*corners(a, 1, :) - 0.1_wp
      corners(a, 2, :) = n(a)*corners(a, 2, :) + 0.1_wp
    end do
    window = new_window(n, periodic, corners)
  end function window_of

  subroutine check_transfer(n, periodic, name)
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    character(len=*), intent(in) :: name

    type(boxes_t) :: boxes
    type(outcome_t) :: outcome
    type(window_t) :: window
    type(transfer_t) :: transfer
    logical :: ok

    call new_boxes(comm, n, periodic, boxes, outcome)
    ok = outcome%failed()
    if (comm%any_of(ok)) then
      if (comm%is_root()) call expect(.false., 'boxes for '//name)
      return
    end if
    window = window_of(comm%rank, n, periodic)
    call new_transfer(boxes, window, 3, transfer)
    ok = gathered(boxes, window, transfer)
    ok = .not. comm%any_of(.not. ok)
    if (comm%is_root()) call expect(ok, 'every wanted cell is gathered, '//name)
    ok = scattered(boxes, window, transfer, n, periodic)
    ok = .not. comm%any_of(.not. ok)
    if (comm%is_root()) call expect(ok, 'what windows add arrives once each, '//name)
  end subroutine check_transfer

  !> A number that tells which cell and component it is.
  pure function mark(cell, component)
    integer, intent(in) :: cell(3), component
    real(wp) :: mark

    mark = component + 10*(cell(1) + 100*(cell(2) + 100*cell(3)))
  end function mark

  !> Gather fields of 3 and of 1 component; cells not wanted must stay.
  function gathered(boxes, window, transfer) result(ok)
    type(boxes_t), intent(in) :: boxes
    type(window_t), intent(in) :: window
    type(transfer_t), intent(inout) :: transfer
    logical :: ok

    real(wp), allocatable :: box(:,:,:,:), box_one(:,:,:,:), seen(:,:), one(:,:)
    integer :: i, j, k, m, c

    allocate (box(3, boxes%n(1), boxes%n(2), boxes%n(3)))
    allocate (seen(3, window%cells()), one(1, window%cells()), source=-1.0_wp)
    do k = 1, boxes%n(3)
      do j = 1, boxes%n(2)
        do i = 1, boxes%n(1)
          box(:, i, j, k) = [(mark(boxes%lo - 1 + [i, j, k], m), m=1, 3)]
        end do
      end do
    end do
    call transfer%gather(3, box, seen)
    allocate (box_one, source=box(2:2, :, :, :))
    call transfer%gather(1, box_one, one)
    ok = .true.
    do c = 1, window%cells()
      do m = 1, 3
        ok = ok .and. nint(seen(m, c)) == nint(merge(mark(window%cell_at(c), m), -1.0_wp, window%wanted(c)))
      end do
      ok = ok .and. nint(one(1, c)) == nint(seen(2, c))
    end do
  end function gathered

  !> Each window adds its rank + 1 to every cell it wants; every rank can work out what all of them add.
  function scattered(boxes, window, transfer, n, periodic) result(ok)
    type(boxes_t), intent(in) :: boxes
    type(window_t), intent(in) :: window
    type(transfer_t), intent(inout) :: transfer
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    logical :: ok

    type(window_t) :: other
    real(wp), allocatable :: box(:,:,:,:), given(:,:), expected(:,:,:)
    integer :: rank, c, cell(3)

    allocate (box(2, boxes%n(1), boxes%n(2), boxes%n(3)), source=0.5_wp)
    allocate (given(2, window%cells()), source=comm%rank + 1.0_wp)
    given(2, :) = -given(1, :)
    call transfer%scatter_add(2, given, box)
    allocate (expected(n(1), n(2), n(3)), source=0.0_wp)
    do rank = 0, comm%size - 1
      other = window_of(rank, n, periodic)
      do c = 1, other%cells()
        if (.not. other%wanted(c)) cycle
        cell = other%cell_at(c)
        expected(cell(1), cell(2), cell(3)) = expected(cell(1), cell(2), cell(3)) + rank + 1
      end do
    end do
    associate (lo => boxes%lo, hi => boxes%hi)
      ok = all(abs(box(1, :, :, :) - 0.5_wp - expected(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3))) < 1e-12_wp)
      ok = ok .and. all(abs(box(2, :, :, :) - 0.5_wp + expected(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3))) < 1e-12_wp)
    end associate
  end function scattered

end program test_transfer
