!> METIS 5, which cuts a weighted graph into parts of equal weight, or weights of several kinds, with few cut edges.
!>
!> The library counts in integers whose width is chosen when it is built; this file speaks the usual 32 bits.
module metis
  use, intrinsic :: iso_c_binding, only: c_int, c_int32_t, c_ptr, c_null_ptr
  implicit none
  private
  public :: idx_t, graph_t, metis_fits, cut_recursively, cut_directly

  integer, parameter :: idx_t = c_int32_t
  integer, parameter :: options_size = 40  !< METIS_NOPTIONS
  integer, parameter :: success = 1        !< METIS_OK

  !> Places of the options in metis.h, counted from 1.
  integer, parameter :: cuts_at = 16, seed_at = 9, unevenness_at = 17, numbering_at = 18

  !> Neighbours of vertex v are neighbour(first(v) + 1 : first(v + 1)); vertices count from 0.
  type :: graph_t
    integer(idx_t), allocatable :: first(:)      !< (vertices + 1)
    integer(idx_t), allocatable :: neighbour(:)  !< (edges, each from both ends)
    integer(idx_t), allocatable :: weight(:,:)   !< (kinds, vertices) each kind is to be shared out evenly
    integer(idx_t), allocatable :: edge(:)       !< (edges) weights, the same from both ends
  end type graph_t

  interface
    function metis_set_default_options(options) bind(C, name='METIS_SetDefaultOptions') result(code)
      import :: c_int, idx_t
      implicit none
      integer(idx_t), intent(inout) :: options(*)
      integer(c_int) :: code
    end function metis_set_default_options

    function metis_part_graph_kway(vertices, constraints, first, neighbour, weight, sizes, edge, parts, shares, &
                                   balances, options, cut, part) bind(C, name='METIS_PartGraphKway') result(code)
      import :: c_int, idx_t, c_ptr
      implicit none
      integer(idx_t), intent(in) :: vertices, constraints, first(*), neighbour(*), weight(*), edge(*), parts, options(*)
      type(c_ptr), value :: sizes, shares, balances
      integer(idx_t), intent(out) :: cut
      integer(idx_t), intent(inout) :: part(*)
      integer(c_int) :: code
    end function metis_part_graph_kway

    function metis_part_graph_recursive(vertices, constraints, first, neighbour, weight, sizes, edge, parts, shares, &
                                        balances, options, cut, part) bind(C, name='METIS_PartGraphRecursive') &
      result(code)
      import :: c_int, idx_t, c_ptr
      implicit none
      integer(idx_t), intent(in) :: vertices, constraints, first(*), neighbour(*), weight(*), edge(*), parts, options(*)
      type(c_ptr), value :: sizes, shares, balances
      integer(idx_t), intent(out) :: cut
      integer(idx_t), intent(inout) :: part(*)
      integer(c_int) :: code
    end function metis_part_graph_recursive
  end interface

contains

  !> Whether the library's integers are as wide as ours.
  !> It marks its options with -1; wider integers would reach beyond as many of ours.
  function metis_fits() result(fits)
    logical :: fits

    integer(idx_t) :: options(2*options_size)

    options = 0
    fits = metis_set_default_options(options) == success
    fits = fits .and. all(options(:options_size) == -1) .and. all(options(options_size + 1:) == 0)
  end function metis_fits

  !> Halve the graph again and again: the better way for few parts. part(v) counts from 0.
  subroutine cut_recursively(graph, parts, unevenness, part, ok)
    type(graph_t), intent(in) :: graph
    integer, intent(in) :: parts
    integer, intent(in) :: unevenness  !< permitted, in thousandths of the mean weight
    integer, intent(out) :: part(:)    !< (vertices)
    logical, intent(out) :: ok

    integer(idx_t) :: cut, label(size(part))

    ok = metis_part_graph_recursive(size(part, kind=idx_t), size(graph%weight, 1, idx_t), graph%first, &
                                    graph%neighbour, graph%weight, &
                                    c_null_ptr, graph%edge, int(parts, idx_t), c_null_ptr, c_null_ptr, &
                                    options(unevenness), cut, label) == success
    part = label
  end subroutine cut_recursively

  !> Cut the graph into all parts at once: the better way for many. part(v) counts from 0.
  subroutine cut_directly(graph, parts, unevenness, part, ok)
    type(graph_t), intent(in) :: graph
    integer, intent(in) :: parts
    integer, intent(in) :: unevenness  !< permitted, in thousandths of the mean weight
    integer, intent(out) :: part(:)    !< (vertices)
    logical, intent(out) :: ok

    integer(idx_t) :: cut, label(size(part))

    ok = metis_part_graph_kway(size(part, kind=idx_t), size(graph%weight, 1, idx_t), graph%first, &
                               graph%neighbour, graph%weight, &
                               c_null_ptr, graph%edge, int(parts, idx_t), c_null_ptr, c_null_ptr, &
                               options(unevenness), cut, label) == success
    part = label
  end subroutine cut_directly

  !> One seed, so that the same graph is always cut the same way; the best of a few attempts.
  function options(unevenness)
    integer, intent(in) :: unevenness
    integer(idx_t) :: options(options_size)

    integer(c_int) :: code

    code = metis_set_default_options(options)
    if (code /= success) error stop 'metis: the options cannot be set'
    options(seed_at) = 1
    options(cuts_at) = 4
    options(unevenness_at) = int(unevenness, idx_t)
    options(numbering_at) = 0
  end function options

end module metis
