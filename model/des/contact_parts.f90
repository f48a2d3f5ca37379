!> Listed pairs dealt by their laws, so that a sweep over one part has one law and looks nothing up.
!>
!> While there are several laws each has a list and close pairs of its own, which keep the slips. Those of all pairs are only
!> used when lists are made.
module contact_parts
  use close_pairs, only: close_pairs_t
  use cohesion_sweep, only: attract_pairs
  use contact_law, only: contact_law_t
  use contact_laws, only: contact_laws_t
  use contact_list, only: contact_list_t
  use contact_sweep, only: sweep_friction, sweep_frictionless
  use kinds, only: wp
  use parcels, only: parcels_t
  implicit none
  private
  public :: part_t, deal, gathered, are_due, begin_pairs, second_of_pairs, any_tight, widest_window, sweep_rows, attract_rows

  !> The pairs of one law.
  type :: part_t
    type(contact_list_t) :: list
    type(close_pairs_t) :: pairs
  end type part_t

contains

  !> Deal a list, of which all pairs are close, by the law of each pair of powders; the order stays.
  subroutine deal(list, pairs, laws, powder, parts)
    type(contact_list_t), intent(in) :: list
    type(close_pairs_t), intent(in) :: pairs
    type(contact_laws_t), intent(in) :: laws
    integer, intent(in) :: powder(:)       !< of each column, ghosts included
    type(part_t), intent(inout) :: parts(:)  !< one for each law

    integer :: number(list%entries), c, i, k, n

    do k = 1, list%entries
      number(k) = laws%of_pair(powder(list%row(k)), powder(list%partner(k)))
    end do
    do c = 1, size(parts)
      associate (part => parts(c)%list)
        call part%start(list%rows)
        call part%reserve(count(number == c))
        do i = 1, list%rows
          do k = list%first(i), list%first(i + 1) - 1
            if (number(k) /= c) cycle
            part%entries = part%entries + 1
            part%partner(part%entries) = list%partner(k)
          end do
          part%first(i + 1) = part%entries + 1
        end do
        call part%note_rows()
      end associate
      parts(c)%pairs%with_history = pairs%with_history
      parts(c)%pairs%with_angles = pairs%with_angles
      call parts(c)%pairs%take_all(parts(c)%list)
      if (.not. pairs%with_history) cycle
      n = 0
      do k = 1, list%entries
        if (number(k) /= c) cycle
        n = n + 1
        if (pairs%remembers(k)) call parts(c)%pairs%remind(n, pairs%memory_of(k))
      end do
    end do
  end subroutine deal

  !> Whether pairs of any law are chosen anew when the next step begins: the same on all ranks.
  pure function are_due(pairs, parts)
    type(close_pairs_t), intent(in) :: pairs
    type(part_t), intent(in), allocatable :: parts(:)  !< take the place of pairs
    logical :: are_due

    integer :: c

    are_due = pairs%is_due()
    if (allocated(parts)) are_due = any([(parts(c)%pairs%is_due(), c=1, size(parts))])
  end function are_due

  !> A step in which nothing is swept yet.
  subroutine begin_pairs(list, pairs, parts, state, lengths)
    type(contact_list_t), intent(in) :: list
    type(close_pairs_t), intent(inout) :: pairs
    type(part_t), intent(inout), allocatable :: parts(:)  !< take the place of list and pairs
    real(wp), intent(in), contiguous :: state(:,:)        !< see parcels
    real(wp), intent(in) :: lengths(3)  !< way of the fastest parcel in a step, skin, width of a parcel [m]

    integer :: c

    if (.not. allocated(parts)) then
      call pairs%begin_step(list, state, lengths(1), lengths(2), lengths(3))
    else
      do c = 1, size(parts)
        call parts(c)%pairs%begin_step(parts(c)%list, state, lengths(1), lengths(2), lengths(3))
      end do
    end if
  end subroutine begin_pairs

  !> Which parcels are the second of a close pair.
  pure function second_of_pairs(pairs, parts, columns) result(seconds)
    type(close_pairs_t), intent(in) :: pairs
    type(part_t), intent(in), allocatable :: parts(:)  !< take the place of pairs
    integer, intent(in) :: columns                     !< own parcels and ghosts
    logical :: seconds(columns)

    integer :: c

    seconds = .false.
    if (.not. allocated(parts)) then
      call mark(pairs%n, pairs%j, seconds)
    else
      do c = 1, size(parts)
        call mark(parts(c)%pairs%n, parts(c)%pairs%j, seconds)
      end do
    end if
  end function second_of_pairs

  pure subroutine mark(n, column, marked)
    integer, intent(in) :: n, column(n)
    logical, intent(inout) :: marked(:)

    integer :: k

    do k = 1, n
      marked(column(k)) = .true.
    end do
  end subroutine mark

  !> Whether pairs of any law are tight.
  pure function any_tight(pairs, parts)
    type(close_pairs_t), intent(in) :: pairs
    type(part_t), intent(in), allocatable :: parts(:)  !< take the place of pairs
    logical :: any_tight

    any_tight = pairs%tight
    if (allocated(parts)) any_tight = any(parts%pairs%tight)
  end function any_tight

  !> Columns that tight pairs of a stretch may need.
  pure function widest_window(pairs, parts) result(window)
    type(close_pairs_t), intent(in) :: pairs
    type(part_t), intent(in), allocatable :: parts(:)  !< take the place of pairs
    integer :: window

    window = pairs%window
    if (allocated(parts)) window = maxval(parts%pairs%window)
  end function widest_window

  !> Add the forces of all pairs in the rows up to `row` that are not swept yet.
  subroutine sweep_rows(laws, row, pairs, parts, parcels)
    type(contact_laws_t), intent(in) :: laws
    integer, intent(in) :: row
    type(close_pairs_t), intent(inout) :: pairs
    type(part_t), intent(inout), allocatable :: parts(:)  !< take the place of pairs
    type(parcels_t), intent(inout) :: parcels

    integer :: c

    if (.not. allocated(parts)) then
      call sweep_pairs(laws%pair(1), pairs, row, parcels)
    else
      do c = 1, size(parts)
        call sweep_pairs(laws%pair(c), parts(c)%pairs, row, parcels)
      end do
    end if
  end subroutine sweep_rows

  !> Add the attraction of all listed pairs in some rows.
  subroutine attract_rows(laws, list, parts, rows, parcels)
    type(contact_laws_t), intent(in) :: laws
    type(contact_list_t), intent(in) :: list
    type(part_t), intent(in), allocatable :: parts(:)  !< take the place of the list
    integer, intent(in) :: rows(2)                     !< first and last
    type(parcels_t), intent(inout) :: parcels

    integer :: c

    do c = 1, size(laws%pair)
      if (.not. laws%pair(c)%cohesion%on) cycle
      if (.not. allocated(parts)) call attract_pairs(laws%pair(c)%cohesion, list, rows, parcels)
      if (allocated(parts)) call attract_pairs(laws%pair(c)%cohesion, parts(c)%list, rows, parcels)
    end do
  end subroutine attract_rows

  !> Add the forces of the pairs of one law, in the rows up to `row` that are not swept yet.
  subroutine sweep_pairs(law, pairs, row, parcels)
    type(contact_law_t), intent(in) :: law
    type(close_pairs_t), intent(inout) :: pairs
    integer, intent(in) :: row
    type(parcels_t), intent(inout) :: parcels

    integer :: last

    last = pairs%last_of_rows(row)
    if (parcels%rotation) then
      call sweep_friction(law, pairs, last, parcels%state, [parcels%n, parcels%ring], parcels%force(parcels%force_start))
    else
      call sweep_frictionless(law, pairs, last, parcels%state, [parcels%n, parcels%ring], parcels%force(parcels%force_start))
    end if
    pairs%swept = last
  end subroutine sweep_pairs

  !> The close pairs of all parts, one part after the other; of their entries in the list nothing is known.
  function gathered(parts) result(pairs)
    type(part_t), intent(in) :: parts(:)
    type(close_pairs_t) :: pairs

    integer :: c, k, before

    pairs%n = sum(parts%pairs%n)
    pairs%with_history = any(parts%pairs%with_history)
    pairs%with_angles = any(parts%pairs%with_angles)
    allocate (pairs%entry(pairs%n), source=0)
    pairs%i = [(parts(c)%pairs%i(1:parts(c)%pairs%n), c=1, size(parts))]
    pairs%j = [(parts(c)%pairs%j(1:parts(c)%pairs%n), c=1, size(parts))]
    call pairs%forget_all()
    if (.not. pairs%with_history) return
    before = 0
    do c = 1, size(parts)
      do k = 1, parts(c)%pairs%n
        if (parts(c)%pairs%remembers(k)) call pairs%remind(before + k, parts(c)%pairs%memory_of(k))
      end do
      before = before + parts(c)%pairs%n
    end do
  end function gathered

end module contact_parts
